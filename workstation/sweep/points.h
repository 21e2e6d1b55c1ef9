// Points of a sweep: what it varies, each some keys of the configuration with their values. Values
// are looked at where they are written, by the configuration's own list of keys.
#pragma once

#include <string>
#include <vector>

#include "workstation/base/answer.h"

namespace bess {

/// Of a plan's file, or none when `plan` is empty: each [[list]] with every combination of [grid]
/// and of `sets`, KEY=VALUE[,VALUE...], the last of these fastest. One empty point when nothing
/// varies. Throws UserError naming file and line.
std::vector<Entries> read_points(const std::string& plan, const std::vector<std::string>& sets);

}  // namespace bess
