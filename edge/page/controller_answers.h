// What `bess-edge` answers, shared by all who look: however many they are, each of its commands
// runs at most once every `refresh_s`, and never twice at a time. It takes no lock and asks nothing
// of the controller itself, which does not know that somebody looks.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "edge/page/page_settings.h"

namespace bess {

struct Answer {
  std::string text;
  std::string trouble;  ///< empty when there is a text; else why there is none
  std::int64_t made_monotonic_ns = 0;

  [[nodiscard]] std::int64_t age_ns() const;
};

/// What a command prints; of a command that prints JSON, nothing else is an answer.
Answer ask_controller(const PageSettings& settings, std::vector<std::string> words, bool is_json);

class KeptAnswer {
 public:
  using Make = std::function<Answer()>;
  KeptAnswer(std::int64_t keep_s, Make make) : keep_s_(keep_s), make_(std::move(make)) {}

  /// Older than `keep_s` only while another thread makes a new one.
  std::shared_ptr<const Answer> newest();

 private:
  /// Null when there is none, or it is too old.
  std::shared_ptr<const Answer> fresh();

  const std::int64_t keep_s_;
  const Make make_;
  std::mutex making_;
  std::mutex lock_;  ///< of what follows
  std::shared_ptr<const Answer> kept_;
};

}  // namespace bess
