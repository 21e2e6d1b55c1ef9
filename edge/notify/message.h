// What is told, before anybody knows by which way.
#pragma once

#include <cstdint>
#include <string>

namespace bess {

enum class MessageKind { kAlarm, kOver, kDay, kTest, kDropped };

struct Message {
  MessageKind kind = MessageKind::kTest;
  std::string key{};             ///< of the alarm; of the day, its date
  std::string text{};            ///< one line
  std::int64_t utc_s = 0;        ///< when it was observed; it may be delivered much later
  std::int64_t since_utc_s = 0;  ///< of an alarm and its end
};

/// "alarm", "over", "day", "test", "dropped".
const char* kind_name(MessageKind kind);
MessageKind kind_of(const std::string& name);

/// "ALARM: ...", one line, for a subject or a bell.
std::string headline(const Message& message);
/// As MQTT carries it, in one line.
std::string message_json(const std::string& node, const Message& message);

}  // namespace bess
