"""A machine that has the kernel's CAN: `python -m tests.hil.machine COMMAND...` runs a command in it.

Where this machine's own kernel can make vcan interfaces, that is a network namespace of its own (`native`). Elsewhere
it is a User-Mode Linux kernel, which is an ordinary process: no root, no image, no /dev/kvm (`uml`). Its root is this
machine's, under an overlay that is thrown away, so the same interpreter, virtual environment and tools are there.
"""
