#include "edge/core/memory/heap_seal.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "edge/core/base/check.h"

namespace bess {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#elif defined(__arm__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_ARM;
#else
#error "the seccomp filter knows x86-64, aarch64 and armhf"
#endif

constexpr std::uint32_t kMemoryCalls[] = {
    __NR_brk,
    __NR_mremap,
#ifdef __NR_mmap
    __NR_mmap,
#endif
#ifdef __NR_mmap2
    __NR_mmap2,
#endif
};
constexpr std::uint32_t kProcessCalls[] = {
    __NR_clone,  __NR_execve, __NR_execveat,
#ifdef __NR_clone3
    __NR_clone3,
#endif
#ifdef __NR_fork
    __NR_fork,   __NR_vfork,
#endif
};

/// The controller is a client only: it accepts no connections.
constexpr std::uint32_t kServerCalls[] = {__NR_bind, __NR_listen, __NR_accept4};

constexpr std::size_t kPrologue = 5;
constexpr std::size_t kSocketRule = 4;
constexpr std::size_t kFilterSize =
    kPrologue + kSocketRule + 1 +
    2 * (std::size(kMemoryCalls) + std::size(kProcessCalls) + std::size(kServerCalls));
using Filter = std::array<sock_filter, kFilterSize>;

constexpr sock_filter statement(std::uint16_t code, std::uint32_t value) {
  return {.code = code, .jt = 0, .jf = 0, .k = value};
}
constexpr sock_filter jump(std::uint16_t code, std::uint32_t value, std::uint8_t skip_if_true,
                           std::uint8_t skip_if_false) {
  return {.code = static_cast<std::uint16_t>(BPF_JMP | code | BPF_K),
          .jt = skip_if_true,
          .jf = skip_if_false,
          .k = value};
}

/// Loads and checks the architecture; loads the call number; two instructions per forbidden call.
Filter make_filter(std::uint32_t memory_answer, std::uint32_t process_answer) {
  constexpr std::uint16_t kLoad = BPF_LD | BPF_W | BPF_ABS;
  constexpr std::uint16_t kReturn = BPF_RET | BPF_K;
  // x86-64 kernels also accept x32 call numbers, which start here: never used.
  constexpr std::uint32_t kX32Numbers = 0x40000000;
  Filter filter{};
  filter[0] = statement(kLoad, offsetof(seccomp_data, arch));
  filter[1] = jump(BPF_JEQ, kArchitecture, 0, 2);
  filter[2] = statement(kLoad, offsetof(seccomp_data, nr));
  filter[3] = jump(BPF_JGE, kX32Numbers, 0, 1);
  filter[4] = statement(kReturn, process_answer);
  std::size_t i = kPrologue;
  const auto forbid = [&](std::uint32_t number, std::uint32_t answer) {
    filter[i++] = jump(BPF_JEQ, number, 0, 1);
    filter[i++] = statement(kReturn, answer);
  };
  for (const std::uint32_t number : kMemoryCalls) forbid(number, memory_answer);
  for (const std::uint32_t number : kProcessCalls) forbid(number, process_answer);
  for (const std::uint32_t number : kServerCalls) forbid(number, process_answer);
  // Only sockets to a battery or meter; the one to systemd is already open.
  constexpr std::size_t kDomain = offsetof(seccomp_data, args);  // its low half: little-endian
  filter[i++] = jump(BPF_JEQ, __NR_socket, 0, 3);
  filter[i++] = statement(kLoad, kDomain);
  filter[i++] = jump(BPF_JEQ, AF_INET, 1, 0);
  filter[i++] = statement(kReturn, process_answer);
  filter[i] = statement(kReturn, SECCOMP_RET_ALLOW);
  return filter;
}

}  // namespace

int install_seccomp_filter(ForbiddenCall consequence) {
  const bool kills = consequence == ForbiddenCall::kKills;
  Filter filter = make_filter(kills ? SECCOMP_RET_KILL_PROCESS : SECCOMP_RET_ERRNO | ENOMEM,
                              kills ? SECCOMP_RET_KILL_PROCESS : SECCOMP_RET_ERRNO | EPERM);
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()),
                           .filter = filter.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return errno;
  const long result =
      syscall(__NR_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program);
  if (result < 0) return errno;
  return result == 0 ? 0 : EBUSY;  // id of a thread that could not be synchronised
}

namespace {

#ifdef BESS_SANITIZED
constexpr bool kIsSealed = false;
#else
constexpr bool kIsSealed = true;
#endif
constexpr std::size_t kThreadStackBytes = 256 * 1024;  // measured use: at most 20 KiB

/// Writes one line to stderr with write(2): stdio would allocate its buffer.
template <typename... Values>
void put_line(const char* format, Values... values) {
  char line[256];
  const int length = std::snprintf(line, sizeof line, format, values...);
  const auto size = static_cast<std::size_t>(length) < sizeof line
                        ? static_cast<std::size_t>(length)
                        : sizeof line - 1;
  const ssize_t ignored = write(STDERR_FILENO, line, size);
  static_cast<void>(ignored);
}

/// Touches the stack that the control thread will need.
void prefault_stack() {
  volatile char stack[kControlStackBytes];
  for (std::size_t i = 0; i < sizeof stack; i += 512) stack[i] = 0;
}

std::atomic<bool> is_sealed = false;
std::atomic<std::uint32_t> allocator_calls = 0;

/// True if malloc_family.cpp is in use.
bool counts_allocator_calls() {
  const std::uint32_t before = allocator_calls;
  std::free(strdup("allocator probe"));
  return allocator_calls != before;
}

void lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return;
  const int error = errno;
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  munlockall();  // all or nothing: with half a lock a later page fault would be fatal
  put_line(
      "bess-edge: note: memory is not locked (%s, limit %llu KiB): set LimitMEMLOCK=infinity in "
      "the unit, or ulimit -l\n",
      std::strerror(error), static_cast<unsigned long long>(limit.rlim_cur / 1'024));
}

void forbid_system_calls() {
  const char* setting = std::getenv("BESS_SECCOMP");
  const bool kills = setting != nullptr && std::string_view(setting) == "kill";
  const int error = install_seccomp_filter(kills ? ForbiddenCall::kKills : ForbiddenCall::kFails);
  if (error == 0) return;
  put_line("bess-edge: note: this kernel has no seccomp (%s): continuing without its filter\n",
           std::strerror(error));
}

}  // namespace

bool prepare_memory() {
  if (!kIsSealed) return true;
  pthread_attr_t thread;
  pthread_attr_init(&thread);
  pthread_attr_setstacksize(&thread, kThreadStackBytes);
  pthread_setattr_default_np(&thread);  // stacks are locked in whole
  pthread_attr_destroy(&thread);
  mallopt(M_ARENA_MAX, 1);  // of the C library: one arena for all threads, or each reserves 64 MiB
  if (counts_allocator_calls()) return true;
  put_line("%s",
           "bess-edge: malloc is not replaced: build bess-edge with malloc_family.cpp and "
           "default visibility; unset LD_PRELOAD\n");
  return false;
}

void require_unsealed_heap() {
  allocator_calls.fetch_add(1, std::memory_order_relaxed);
  if (is_sealed.load(std::memory_order_relaxed)) {
    is_sealed = false;  // for a failed CHECK
    check_failed("no allocator call after start-up", "malloc_family.cpp", 0);
  }
}

HeapSeal::HeapSeal() {
  if (!kIsSealed) {
    put_line("%s", "bess-edge: note: sanitizer build, not sealed\n");
    return;
  }
  malloc_trim(0);  // memory freed by start-up need not be locked
  prefault_stack();
  lock_memory();
  forbid_system_calls();
  is_sealed = true;
}

HeapSeal::~HeapSeal() {
  if (!kIsSealed) return;
  is_sealed = false;
  put_line("%s", "bess-edge: ran sealed: no allocator call after start-up\n");
}

}  // namespace bess
