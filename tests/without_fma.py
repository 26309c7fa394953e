"""Environment in which the C library computes as on a processor without fused multiply-add; x86 with glibc only."""

WITHOUT_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"}
