"""Mid level: RLAs over the passed junctions (paper, sections V.B and VI.B.2)."""
