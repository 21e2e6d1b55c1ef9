#include "edge/page/controller_answers.h"

#include "shared/host/json.h"
#include "shared/host/run_program.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kAnswerS = 10;
constexpr int kSignalled = 128;  ///< exit codes from here on are signals

}  // namespace

std::int64_t Answer::age_ns() const { return clock_ns(CLOCK_MONOTONIC) - made_monotonic_ns; }

Answer ask_controller(const PageSettings& settings, std::vector<std::string> words, bool is_json) {
  words.insert(words.begin(), settings.program);
  words.insert(words.end(), {"--config", settings.config_path});
  ProgramResult result = run_and_hear(words, kAnswerS);
  // A controller that is degraded or gone says so by the exit code, and gives its answer.
  const bool has_ended = result.trouble.empty() && result.exit_code < kSignalled;
  const bool is_answer =
      is_json ? Json::parse(result.output).value().exists() : !result.output.empty();
  Answer answer;
  if (has_ended && is_answer) {
    answer.text = std::move(result.output);
  } else {
    answer.trouble = result.complaint();
  }
  answer.made_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
  return answer;
}

std::shared_ptr<const Answer> KeptAnswer::fresh() {
  const std::scoped_lock lock(lock_);
  const bool is_fresh = kept_ != nullptr && kept_->age_ns() < keep_s_ * kNanosecondsPerSecond;
  return is_fresh ? kept_ : nullptr;
}

std::shared_ptr<const Answer> KeptAnswer::newest() {
  if (auto answer = fresh()) return answer;
  std::unique_lock making(making_, std::try_to_lock);
  if (!making.owns_lock()) {
    // Another thread is at it: the old one must do, but for the very first.
    {
      const std::scoped_lock lock(lock_);
      if (kept_ != nullptr) return kept_;
    }
    making.lock();
  }
  if (auto answer = fresh()) return answer;
  auto made = std::make_shared<const Answer>(make_());
  const std::scoped_lock lock(lock_);
  return kept_ = std::move(made);
}

}  // namespace bess
