// What `bess-edge commission` found out, kept beside the other state: without it, or when map,
// variant or address have changed since, the battery is not controlled. It lies in three places,
// each with a checksum: twice in the [state] folder, for a card that forgets bytes or a file, and
// in run_folder, for one that dies: the first that is whole counts. Start-up only.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "edge/device/battery/commission.h"

namespace bess {

/// To all places, each written beside and renamed. False with one line in `error` where the first
/// cannot be.
bool write_commission_file(const EdgeConfig& config, const CommissionResult& result,
                           std::int64_t utc_s, std::string& error);

/// False with one line in `error`, which says what differs and how to mend it.
bool is_commissioned(const EdgeConfig& config, std::string& error);

/// Optional points that the commissioned device has; none where an older program wrote the file.
std::vector<std::int8_t> commissioned_points(const EdgeConfig& config);

/// A line for each place that was lost or damaged while another counts; nothing is written.
std::vector<std::string> commission_file_losses(const EdgeConfig& config);

/// Writes the places that have lost it again, from the one that counts. A line for the journal for
/// each loss; a run folder that a boot has emptied is none.
std::vector<std::string> mend_commission_file(const EdgeConfig& config);

}  // namespace bess
