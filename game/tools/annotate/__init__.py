"""The annotation desk (EMBOS, figure 3): marking what is seen in takes, by hand and by learning from other takes."""
