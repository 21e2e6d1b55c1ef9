// The kernel's part of the seal: system calls that give memory, threads or programs are forbidden
// to every thread of the process from now on. Raw BPF, for x86-64, aarch64 and armhf.
#pragma once

namespace bess {

enum class ForbiddenCall {
  kFails,  ///< with ENOMEM (memory) or EPERM (threads, programs)
  kKills,  ///< the process, with SIGSYS
};

/// 0, or the errno of a kernel without seccomp (qemu-user: ENOSYS or EINVAL).
int install_seccomp_filter(ForbiddenCall consequence);

}  // namespace bess
