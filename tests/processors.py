"""Environments in which the libraries compute as on another processor; x86 with glibc only."""

OF_2004 = {
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F",
}
"""Processor that has no fused multiply-add."""
OF_2013 = {"OPENBLAS_CORETYPE": "Haswell"}
