// A sweep on Slurm: a thin client of job arrays. What is missing and does not wait already is sent
// as one array, a chunk of tasks an element, and the client leaves; called again it sends what is
// missing then. Slurm is asked only what waits and runs (squeue) and how much it takes (scontrol):
// it forgets what is over, so that files alone say what is done. What was sent is written down
// before it is sent, under the name that the job bears: a client that dies in between loses
// nothing, and two clients at once send a task twice at worst, which does no harm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

/// What an array may be.
struct SlurmLimits {
  int array_max = 1001;   ///< MaxArraySize: the largest index is one less
  int jobs_max = 10'000;  ///< MaxJobCount, of all users
  int jobs_now = 0;
};

/// One line of submissions/N.tsv: what an element of the array runs.
using Chunks = std::vector<std::vector<int>>;

/// "MaxArraySize = 1001" of 'scontrol show config'.
SlurmLimits parse_limits(const std::string& config);

/// How many of them: a minute of work each, at a task's seconds (0: unknown), and a thousand at
/// most: Slurm starts some few a second, and more of them are no quicker.
int elements_wanted(std::size_t tasks, double task_s);
/// At most `elements_max` of them; `chunk` tasks each, or 0 for as many as that needs.
Chunks chunked(const std::vector<int>& tasks, int chunk, int elements_max);

/// Of "NAME_INDEX" pairs as squeue lists them: which elements of which submission wait or run.
struct WaitingElement {
  int submission;
  int element;
};
std::vector<WaitingElement> parse_queue(const std::string& queue, const std::string& sweep_id);

struct SlurmRequest {
  int at_once = 256;
  int chunk = 0;                          ///< 0: by what a task takes, and the limits
  double task_s = 0;                      ///< 0: unknown
  std::vector<std::string> options = {};  ///< for sbatch
};

struct Submission {
  int tasks = 0;  ///< sent now; 0: nothing was missing, or all of it waits
  int elements = 0;
  int chunk = 0;
  int waiting = 0;      ///< tasks that wait or run already
  std::string command;  ///< as it was called
  std::string job;      ///< what sbatch said; or what squeue shows, when its answer was lost
};

/// Throws UserError when Slurm is not there, or refuses.
Submission submit(const SweepFolder& folder, const std::string& sweep_id,
                  const std::vector<int>& missing, const SlurmRequest& request);

/// The tasks of one element. Throws UserError when there is none.
std::vector<int> tasks_of_element(const SweepFolder& folder, int submission, int element);

/// Tasks that wait or run by what squeue says; none without Slurm or submissions.
std::vector<int> waiting_tasks(const SweepFolder& folder, const std::string& sweep_id);

}  // namespace bess
