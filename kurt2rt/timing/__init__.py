"""Time as an object: clocks, the 100 Hz scheduler, and the ledger of where a tick's time goes."""
