// One attempt at a task: a folder of its own, named after who is at work, published by one rename
// onto a name that does not exist. So two copies of a task do no harm: the second compares what it
// has with what is there. Nobody is trusted to live: an attempt whose program is gone is counted as
// a failure by the next one, which goes on in its folder; one that was ended on purpose is not.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

/// After so many attempts that came to nothing a task is left alone.
inline constexpr int kFailuresMax = 3;

/// HOST.MACHINE.PID.START: who this program is, on any machine. MACHINE tells boots and containers
/// of one name apart, START a PID from an older one's.
std::string own_name();
/// True when it was on this machine and is there no more; who is elsewhere is never called gone.
bool is_gone(const std::string& who);
/// Of an attempt that was ended on purpose, behind its name: by Ctrl-C, or by an engine's TERM. It
/// is no failure, and whoever comes next goes on in it, on any machine.
inline constexpr const char* kEnded = ".ended";

enum class TaskEnd {
  kPublished,
  kAlreadyThere,  ///< before anything was done
  kSame,          ///< another copy was first, and made the same
  kDifferent,     ///< another copy was first, and made something else
};

/// Makes the files of a task in the folder that it is given, in which an earlier attempt may have
/// left some.
using TaskWork = std::function<void(const std::filesystem::path&)>;

/// Of a folder: each file's name and mark, but for what is different each time (times.json).
std::vector<std::string> marks_of_folder(const std::filesystem::path& folder);

/// Why attempts at a task failed, one line each.
std::vector<std::string> failures_of(const SweepFolder& folder, int task);
/// Attempts of programs that are gone become failures.
void count_dead_attempts(const SweepFolder& folder, int task);

/// A result without its record is half of one, as a copy by hand leaves it: no result.
bool is_published(const SweepFolder& folder, int task);

/// Once, unless it is published already. Throws what `work` throws, after noting it as a failure,
/// and UserError when the task failed too often before.
TaskEnd attempt_task(const SweepFolder& folder, int task, const TaskWork& work);

}  // namespace bess
