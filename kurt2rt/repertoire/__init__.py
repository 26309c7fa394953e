"""Actions that were taught themselves: RLA systems that stand in a repertoire beside motor values and control loops."""
