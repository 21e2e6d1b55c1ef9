// Exported outlook model of a student with context outlook, from <student_weights.h>; its hash is
// checked at compile time. Include in few files, as exported_student.h.
#pragma once

#include <student_weights.h>

#include "shared/crc32.h"
#include "shared/outlook/outlook_model.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

#ifdef BESS_STUDENT_OUTLOOK_HASH
namespace detail {
constexpr std::uint32_t hash_of_exported_outlook() {
  Crc32 crc;
  for (const std::int32_t number : bess_student_outlook) crc.add_integer(number);
  return crc.value();
}

inline OutlookModel assemble_exported_outlook() {
  OutlookModel model;
  const std::int32_t* from = bess_student_outlook;
  OutlookModel::visit(model, [&from](const char*, std::int32_t* values, int count) {
    for (int i = 0; i < count; ++i) values[i] = *from++;
  });
  return model;
}
}  // namespace detail

static_assert(BESS_STUDENT_OUTLOOK_HASH == detail::hash_of_exported_outlook(),
              "the outlook of student_weights.h is damaged or was edited by hand: export it again");
static_assert(sizeof bess_student_outlook == sizeof(OutlookModel),
              "student_weights.h has an outlook of another format: export it again");
inline constexpr std::uint32_t kExportedOutlookHash = BESS_STUDENT_OUTLOOK_HASH;

/// Null for another context of the student.
inline const OutlookModel* exported_outlook() {
  static const OutlookModel model = detail::assemble_exported_outlook();
  return &model;
}
/// 1 if plans differ from those of the exporter, or the model is invalid.
inline int count_exported_outlook_failures() {
  static OutlookPlan plan;
  const OutlookModel& model = *exported_outlook();
  return model.is_sound() && outlook_check(model, plan) == BESS_STUDENT_OUTLOOK_CHECK ? 0 : 1;
}
inline constexpr int kExportedOutlookCheckCount = 1;
#else
inline constexpr std::uint32_t kExportedOutlookHash = 0;
inline const OutlookModel* exported_outlook() { return nullptr; }
inline int count_exported_outlook_failures() { return 0; }
inline constexpr int kExportedOutlookCheckCount = 0;
#endif

}  // namespace bess
