"""Navigation: places and ways taught in a guided tour, then goals that no tour demonstrated as a whole."""
