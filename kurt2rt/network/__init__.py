"""The RLA network: which RLAs follow each other, and how often (paper, III.B)."""
