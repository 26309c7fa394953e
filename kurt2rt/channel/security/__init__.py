"""Pairing, OSCORE contexts and paired devices. Used by both ends."""
