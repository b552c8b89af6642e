"""Play many talks without a window."""
