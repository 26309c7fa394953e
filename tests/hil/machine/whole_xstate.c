// Let User-Mode Linux 6.1 set the floating-point registers of its processes on processors with AMX.
//
// The kernel reads and writes 2696 bytes of them, all that there was up to AVX-512. Linux takes a whole buffer only
// (xstateregs_set in arch/x86/kernel/fpu/regset.c returns EFAULT), and with AMX that is 11008 bytes. What the kernel does
// not know of is written back as it is. Preloaded into the kernel's process.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <elf.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

#define LARGEST 32768

typedef long (*Ptrace)(int request, pid_t pid, void *address, void *data);

long ptrace(enum __ptrace_request request, ...)
{
    static Ptrace real;
    if (!real)
        real = (Ptrace)dlsym(RTLD_NEXT, "ptrace");
    va_list rest;
    va_start(rest, request);
    pid_t pid = va_arg(rest, pid_t);
    void *address = va_arg(rest, void *);
    void *data = va_arg(rest, void *);
    va_end(rest);
    if (request == PTRACE_SETREGSET && (long)address == NT_X86_XSTATE) {
        // One thread of the kernel traces; its stacks are small.
        static char whole[LARGEST] __attribute__((aligned(64)));
        struct iovec *given = data, all = {whole, sizeof whole};
        if (real(PTRACE_GETREGSET, pid, address, &all) == 0 && all.iov_len > given->iov_len) {
            memcpy(whole, given->iov_base, given->iov_len);
            return real(request, pid, address, &all);
        }
    }
    return real(request, pid, address, data);
}
