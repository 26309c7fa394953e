"""Small school robot as a plug-in: seven infra-red sensors as on the Thymio, over a line protocol on a serial port."""
