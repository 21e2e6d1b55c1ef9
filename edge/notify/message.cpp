#include "edge/notify/message.h"

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr MessageKind kKinds[] = {MessageKind::kAlarm, MessageKind::kOver, MessageKind::kDay,
                                  MessageKind::kTest, MessageKind::kDropped};

bool is_about_alarm(MessageKind kind) {
  return kind == MessageKind::kAlarm || kind == MessageKind::kOver;
}

}  // namespace

const char* kind_name(MessageKind kind) {
  switch (kind) {
    case MessageKind::kAlarm:
      return "alarm";
    case MessageKind::kOver:
      return "over";
    case MessageKind::kDay:
      return "day";
    case MessageKind::kDropped:
      return "dropped";
    case MessageKind::kTest:
      break;
  }
  return "test";
}

MessageKind kind_of(const std::string& name) {
  for (const MessageKind kind : kKinds) {
    if (name == kind_name(kind)) return kind;
  }
  return MessageKind::kTest;
}

std::string headline(const Message& message) {
  const std::string text = one_line(message.text, 400);
  switch (message.kind) {
    case MessageKind::kAlarm:
      return "ALARM: " + text;
    case MessageKind::kOver:
      return "over: " + text;
    case MessageKind::kDay:
      return "day " + text;
    case MessageKind::kDropped:
      return "NOTE: " + text;
    case MessageKind::kTest:
      break;
  }
  return "test: " + text;
}

std::string message_json(const std::string& node, const Message& message) {
  Json json = Json::object({{"node", node},
                            {"kind", kind_name(message.kind)},
                            {"key", message.key},
                            {"text", message.text},
                            {"utc", utc_text(message.utc_s).view()}});
  if (is_about_alarm(message.kind)) json.set("since_utc", utc_text(message.since_utc_s).view());
  return json.line();
}

}  // namespace bess
