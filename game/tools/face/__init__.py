"""The face workshop: proposals, ratings, fits, plots, the authoring window. Offline only."""
