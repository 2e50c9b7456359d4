// Preloaded into user-mode Linux on processors with AMX, by `run` beside it.
//
// Its buffer for a process's extended registers (6.1: struct _xstate, up to AVX-512) is shorter than what such a processor has, and the host's
// kernel refuses a PTRACE_SETREGSET of NT_X86_XSTATE that is not whole (arch/x86/kernel/fpu/regset.c, xstateregs_set: EFAULT); the guest then
// panics at its first process with "ptrace set fp regs failed, errno = 14". Here what is missing is filled up with what the process has; the
// tiles, which nothing in the guest uses, are marked as not in use.

#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace {

constexpr std::uintptr_t kExtended = 0x202;                // NT_X86_XSTATE
constexpr std::size_t kInUse = 512;                        // XSTATE_BV: which components are in use
constexpr std::uint64_t kTiles = std::uint64_t{3} << 17U;  // XTILECFG, XTILEDATA

long set_extended(const int process, const iovec& part) {
    static unsigned char registers[1U << 16U];  // one thread traces
    iovec all{registers, sizeof registers};
    std::uint64_t in_use = 0;
    const bool cut_off = part.iov_len >= kInUse + sizeof in_use && part.iov_len <= sizeof registers &&
                         syscall(SYS_ptrace, PTRACE_GETREGSET, process, kExtended, &all) == 0 && all.iov_len > part.iov_len;
    if (!cut_off) return syscall(SYS_ptrace, PTRACE_SETREGSET, process, kExtended, &part);
    std::memcpy(registers, part.iov_base, part.iov_len);
    std::memcpy(&in_use, registers + kInUse, sizeof in_use);
    in_use &= ~kTiles;
    std::memcpy(registers + kInUse, &in_use, sizeof in_use);
    return syscall(SYS_ptrace, PTRACE_SETREGSET, process, kExtended, &all);
}

}  // namespace

extern "C" long ptrace(const __ptrace_request request, ...) noexcept {
    va_list rest;
    va_start(rest, request);
    const int process = va_arg(rest, int);
    void* const address = va_arg(rest, void*);
    void* const data = va_arg(rest, void*);
    va_end(rest);
    if (request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == kExtended)
        return set_extended(process, *static_cast<const iovec*>(data));
    if (request == PTRACE_PEEKTEXT || request == PTRACE_PEEKDATA || request == PTRACE_PEEKUSER) {
        // The C library returns the word; the kernel puts it where the data points.
        long word = 0;
        const long status = syscall(SYS_ptrace, request, process, address, &word);
        if (status < 0) return status;
        errno = 0;
        return word;
    }
    return syscall(SYS_ptrace, request, process, address, data);
}
