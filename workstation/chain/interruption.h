// Ctrl-C and SIGTERM. Whatever is written appears complete or not at all, so that a command that
// has nothing to save ends at once; one that has is told, and a second signal ends it at once too.
#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace bess {

/// From here on they end the program at once, with exit code 3: files being written are removed,
/// and `note` is said, one line on what is kept and how to go on.
void end_when_interrupted(const std::string& note = "");

/// From here on the first only raises the flag: a loop looks at it, saves what it has and returns.
/// The second ends the program at once, with exit code 130.
void watch_interruption();
std::atomic<bool>& interruption();

/// The flag as a question. Watching begins when it is asked for the first time: before that a loop
/// has nothing to save.
std::function<bool()> watched_from_the_first_look();

/// Returns within a tenth of a second once interrupted.
void sleep_unless(double seconds, const std::atomic<bool>& interrupted);

}  // namespace bess
