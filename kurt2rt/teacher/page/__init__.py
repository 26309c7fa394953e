"""The teacher's page: a small web server beside the teacher, itself a client of the robot over CoAP and OSCORE."""
