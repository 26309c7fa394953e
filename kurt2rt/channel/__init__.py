"""The teacher's channel: CoAP over UDP, every message but discovery protected by OSCORE (docs/the-wire.md)."""
