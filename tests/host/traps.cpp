#include "tests/host/traps.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <ctime>

namespace host_test::traps {

namespace {

// Thread-local and constant-initialised, in the executable's own TLS block: reading it allocates nothing, also inside malloc.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): functions of the C library have no `this`
constinit thread_local bool armed = false;
constinit thread_local std::uint64_t counts[kCalls] = {};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

void note(const Call call) {
    if (armed) ++counts[static_cast<std::size_t>(call)];
}

/// The C library's own function behind the trap.
template <typename Function>
Function* behind(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

Armed::Armed() {
    armed = true;
}
Armed::~Armed() {
    armed = false;
}
Disarmed::Disarmed() : before_(armed) {
    armed = false;
}
Disarmed::~Disarmed() {
    armed = before_;
}

std::uint64_t caught(const Call call) {
    return counts[static_cast<std::size_t>(call)];
}

std::uint64_t caught() {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counts) sum += count;
    return sum;
}

void clear() {
    for (std::uint64_t& count : counts) count = 0;
}

}  // namespace host_test::traps

// operator new and delete of libstdc++ come through here, too.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the C library's names
extern "C" {

using host_test::traps::Call;
using host_test::traps::note;

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* block);

void* malloc(const size_t size) {
    note(Call::allocate);
    return __libc_malloc(size);
}

void* calloc(const size_t count, const size_t size) {
    note(Call::allocate);
    return __libc_calloc(count, size);
}

void* realloc(void* block, const size_t size) {
    note(Call::allocate);
    return __libc_realloc(block, size);
}

void* aligned_alloc(const size_t alignment, const size_t size) {
    note(Call::allocate);
    return __libc_memalign(alignment, size);
}

void free(void* block) {
    if (block != nullptr) note(Call::release);
    __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
    note(Call::lock);
    static const auto next = host_test::traps::behind<int(pthread_mutex_t*)>("pthread_mutex_lock");
    return next(mutex);
}

int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
    note(Call::lock);
    static const auto next = host_test::traps::behind<int(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
    return next(lock);
}

int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
    note(Call::wait_condition);
    static const auto next = host_test::traps::behind<int(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
    return next(condition, mutex);
}

ssize_t write(const int descriptor, const void* bytes, const size_t count) {
    note(Call::write);
    static const auto next = host_test::traps::behind<ssize_t(int, const void*, size_t)>("write");
    return next(descriptor, bytes, count);
}

size_t fwrite(const void* bytes, const size_t size, const size_t count, FILE* stream) {
    note(Call::print);
    static const auto next = host_test::traps::behind<size_t(const void*, size_t, size_t, FILE*)>("fwrite");
    return next(bytes, size, count, stream);
}

int printf(const char* format, ...) {
    note(Call::print);
    static const auto next = host_test::traps::behind<int(const char*, va_list)>("vprintf");
    va_list arguments;
    va_start(arguments, format);
    const int written = next(format, arguments);
    va_end(arguments);
    return written;
}

int puts(const char* text) {
    note(Call::print);
    static const auto next = host_test::traps::behind<int(const char*)>("puts");
    return next(text);
}

int nanosleep(const timespec* request, timespec* remaining) {
    note(Call::sleep);
    static const auto next = host_test::traps::behind<int(const timespec*, timespec*)>("nanosleep");
    return next(request, remaining);
}

void* __cxa_allocate_exception(const size_t size) noexcept {
    note(Call::throw_exception);
    static const auto next = host_test::traps::behind<void*(size_t)>("__cxa_allocate_exception");
    return next(size);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
