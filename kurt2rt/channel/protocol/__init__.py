"""Wire format of the teacher channel: requests, states, codecs. Used by both ends."""
