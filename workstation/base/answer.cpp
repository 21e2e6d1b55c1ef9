#include "workstation/base/answer.h"

namespace bess {

Json answer(const char* kind) {
  return Json::object({{"schema_version", kSchemaVersion}, {"answer", kind}});
}

Json text_or_null(const std::string& text) { return text.empty() ? Json::null() : Json(text); }

}  // namespace bess
