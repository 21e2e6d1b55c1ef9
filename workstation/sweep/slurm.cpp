#include "workstation/sweep/slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <set>

#include "shared/file_descriptor.h"
#include "shared/host/file.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr int kAsk_s = 30;
constexpr int kSubmit_s = 300;  // sbatch waits two minutes by itself when the queue is full
constexpr int kElementsWanted = 1'000;
constexpr double kElement_s = 60;

std::string ask(const std::vector<std::string>& command) {
  const ProgramResult result = run_and_hear(command, kAsk_s);
  if (!result.is_well()) {
    fail("{}: {}; is Slurm here, and running? Without it: bess-train sweep run DIR --jobs N",
         command[0], result.complaint());
  }
  return result.output;
}

int number_behind(const std::string& config, const std::string& key, int otherwise) {
  std::string_view rest = config;
  while (!rest.empty()) {
    const std::string_view line = take_line(rest);
    const std::size_t equals = line.find('=');
    if (!line.starts_with(key) || equals == line.npos) continue;
    if (line.substr(0, equals).find_last_not_of(' ') + 1 != key.size()) continue;
    const std::size_t at = line.find_first_of("0123456789", equals);
    int value = 0;
    if (at == line.npos ||
        std::from_chars(line.data() + at, line.data() + line.size(), value).ec != std::errc{}) {
      continue;
    }
    return value;
  }
  return otherwise;
}

std::string job_name(const std::string& sweep_id, int submission) {
  return fmt::format("bess-{}-{}", sweep_id, submission);
}

/// Job names and array indices of everything that waits or runs, a pair a line. No user is named:
/// names are this sweep's own.
std::string queue() { return ask({"squeue", "--noheader", "--array", "--format=%j %K"}); }

/// Whether an sbatch that failed, or never answered, did its work nevertheless.
bool is_queued(const std::string& sweep_id, int submission) {
  return std::ranges::count(parse_queue(queue(), sweep_id), submission,
                            &WaitingElement::submission) > 0;
}

fs::path list_of(const SweepFolder& folder, int submission) {
  return folder.submissions() / fmt::format("{}.tsv", submission);
}

/// The next number, taken by making its file: of two clients each gets its own.
int claim_submission(const SweepFolder& folder) {
  fs::create_directories(folder.submissions());
  for (int n = 1;; ++n) {
    const FileDescriptor fd(
        open(list_of(folder, n).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
    if (fd.get() >= 0) return n;
    if (errno != EEXIST) {
      fail("{}: cannot write here: {}", list_of(folder, n).string(), std::strerror(errno));
    }
  }
}

std::string lines_of(const Chunks& chunks) {
  std::string text;
  for (const std::vector<int>& tasks : chunks) text += ranges_text(tasks) + "\n";
  return text;
}

Chunks read_submission(const SweepFolder& folder, int submission) {
  const std::string name = list_of(folder, submission).string();
  const std::string text = read_file(name);
  Chunks chunks;
  for (std::string_view rest = text; !rest.empty();) {
    chunks.push_back(parse_ranges(std::string(take_line(rest)), name));
  }
  return chunks;
}

/// The shell sees paths: each is one word whatever it holds.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string script_of(const SweepFolder& folder, int submission) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return fmt::format(
      "#!/bin/sh\nexec {} sweep task --of {} --submission {} --element "
      "\"$SLURM_ARRAY_TASK_ID\"\n",
      quoted(program.string()), quoted(fs::absolute(folder.path).string()), submission);
}

std::vector<std::string> sbatch_command(const SweepFolder& folder, const std::string& sweep_id,
                                        int submission, std::size_t elements,
                                        const SlurmRequest& request) {
  const fs::path log = fs::absolute(folder.log()) / fmt::format("submission-{}.txt", submission);
  std::vector<std::string> command{"sbatch",
                                   "--parsable",
                                   fmt::format("--job-name={}", job_name(sweep_id, submission)),
                                   fmt::format("--array=1-{}%{}", elements, request.at_once),
                                   "--ntasks=1",
                                   "--cpus-per-task=1",
                                   "--open-mode=append",
                                   fmt::format("--output={}", log.string())};
  command.insert(command.end(), request.options.begin(), request.options.end());
  const fs::path script = folder.submissions() / fmt::format("{}.sh", submission);
  write_file(script, script_of(folder, submission));
  command.push_back(script.string());
  return command;
}

std::vector<int> tasks_in(const SweepFolder& folder, const std::vector<WaitingElement>& waiting) {
  std::set<int> tasks;
  int read = 0;
  Chunks chunks;
  for (const WaitingElement& element : waiting) {
    if (element.submission != read) {
      if (!fs::exists(list_of(folder, element.submission))) continue;
      chunks = read_submission(folder, element.submission);
      read = element.submission;
    }
    const auto index = static_cast<std::size_t>(element.element);
    if (index < 1 || index > chunks.size()) continue;
    tasks.insert(chunks[index - 1].begin(), chunks[index - 1].end());
  }
  return {tasks.begin(), tasks.end()};
}

}  // namespace

SlurmLimits parse_limits(const std::string& config) {
  SlurmLimits limits;
  limits.array_max = number_behind(config, "MaxArraySize", limits.array_max);
  limits.jobs_max = number_behind(config, "MaxJobCount", limits.jobs_max);
  return limits;
}

int elements_wanted(std::size_t tasks, double task_s) {
  if (task_s <= 0) return kElementsWanted;
  const double minutes = std::ceil(static_cast<double>(tasks) * task_s / kElement_s);
  return static_cast<int>(std::clamp(minutes, 1.0, double{kElementsWanted}));
}

Chunks chunked(const std::vector<int>& tasks, int chunk, int elements_max) {
  const auto most = static_cast<std::size_t>(std::max(1, elements_max));
  const std::size_t needed = (tasks.size() + most - 1) / most;
  const std::size_t size = std::max<std::size_t>(chunk > 0 ? static_cast<std::size_t>(chunk) : 1,
                                                 chunk > 0 ? 1 : needed);
  Chunks chunks;
  for (std::size_t at = 0; at < tasks.size() && chunks.size() < most; at += size) {
    const std::size_t end = std::min(tasks.size(), at + size);
    chunks.emplace_back(tasks.begin() + static_cast<std::ptrdiff_t>(at),
                        tasks.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return chunks;
}

std::vector<WaitingElement> parse_queue(const std::string& queue, const std::string& sweep_id) {
  const std::string prefix = fmt::format("bess-{}-", sweep_id);
  std::vector<WaitingElement> waiting;
  for (std::string_view rest = queue; !rest.empty();) {
    std::string_view line = take_line(rest);
    if (!line.starts_with(prefix)) continue;
    line.remove_prefix(prefix.size());
    WaitingElement element{};
    const char* const end = line.data() + line.size();
    const auto [space, bad] = std::from_chars(line.data(), end, element.submission);
    if (bad != std::errc{} || space == end) continue;
    if (std::from_chars(space + 1, end, element.element).ec != std::errc{}) continue;
    waiting.push_back(element);
  }
  std::ranges::sort(waiting, {}, &WaitingElement::submission);
  return waiting;
}

Submission submit(const SweepFolder& folder, const std::string& sweep_id,
                  const std::vector<int>& missing, const SlurmRequest& request) {
  Submission done;
  if (missing.empty()) return done;
  const std::string now = queue();
  const std::vector<int> waiting = tasks_in(folder, parse_queue(now, sweep_id));
  std::vector<int> wanted;
  std::ranges::set_difference(missing, waiting, std::back_inserter(wanted));
  done.waiting = static_cast<int>(missing.size() - wanted.size());
  if (wanted.empty()) return done;
  SlurmLimits limits = parse_limits(ask({"scontrol", "show", "config"}));
  limits.jobs_now = static_cast<int>(std::ranges::count(now, '\n'));
  const int room = std::min(limits.array_max, limits.jobs_max - limits.jobs_now) - 1;
  if (room < 1) {
    fail("Slurm has {} jobs and takes {} (MaxJobCount): wait until some are done, and call again",
         limits.jobs_now, limits.jobs_max);
  }
  const int elements = elements_wanted(wanted.size(), request.task_s);
  const Chunks chunks =
      chunked(wanted, request.chunk, request.chunk > 0 ? room : std::min(room, elements));
  const int number = claim_submission(folder);
  write_file(list_of(folder, number), lines_of(chunks));
  fs::create_directories(folder.log());
  const auto command = sbatch_command(folder, sweep_id, number, chunks.size(), request);
  done.command = fmt::format("{}", fmt::join(command, " "));
  const ProgramResult result = run_and_hear(command, kSubmit_s);
  done.job = result.is_well() ? one_line(result.output, 100) : job_name(sweep_id, number);
  if (!result.is_well() && !is_queued(sweep_id, number)) {
    fail("{}: {}; squeue shows none of it: nothing was sent", done.command, result.complaint());
  }
  done.elements = static_cast<int>(chunks.size());
  done.chunk = static_cast<int>(chunks.front().size());
  for (const std::vector<int>& tasks : chunks) done.tasks += static_cast<int>(tasks.size());
  return done;
}

std::vector<int> tasks_of_element(const SweepFolder& folder, int submission, int element) {
  const Chunks chunks = read_submission(folder, submission);
  const auto index = static_cast<std::size_t>(element);
  if (element < 1 || index > chunks.size()) {
    fail("{}: has {} elements, and no {}", list_of(folder, submission).string(), chunks.size(),
         element);
  }
  return chunks[index - 1];
}

std::vector<int> waiting_tasks(const SweepFolder& folder, const std::string& sweep_id) {
  if (!fs::exists(folder.submissions())) return {};
  const ProgramResult result =
      run_and_hear({"squeue", "--noheader", "--array", "--format=%j %K"}, kAsk_s);
  return result.is_well() ? tasks_in(folder, parse_queue(result.output, sweep_id))
                          : std::vector<int>{};
}

}  // namespace bess
