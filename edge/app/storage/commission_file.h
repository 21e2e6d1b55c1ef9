// Commissioning result on disk, required for control; not valid for another map, variant or
// address. Stored with a checksum in three places: twice in the [state] folder, against lost bytes
// or files, and in run_folder, against a failed disk. The first intact one is used. Start-up only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "edge/device/battery/commission.h"

namespace bess {

/// Writes all places, each atomically. False with one line in `error` if the first fails.
bool write_commission_file(const EdgeConfig& config, const CommissionResult& result,
                           std::int64_t utc_s, std::string& error);

/// False with one line in `error`: difference and remedy.
bool is_commissioned(const EdgeConfig& config, std::string& error);

/// Optional points of the commissioned device; none in a file of an older version.
std::vector<std::int8_t> commissioned_points(const EdgeConfig& config);

/// A line for each lost or damaged place while another is usable; writes nothing.
std::vector<std::string> commission_file_losses(const EdgeConfig& config);

/// Restores lost or damaged places from the usable one. A journal line for each loss; a run folder
/// emptied by a boot is none.
std::vector<std::string> repair_commission_file(const EdgeConfig& config);

}  // namespace bess
