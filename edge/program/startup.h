// What happens before the loop: student, process, battery, what earlier runs left.
// One line per finding, for a person; nothing here writes to the battery.
#pragma once

#include "edge/battery/modbus_battery.h"
#include "edge/log/event_log.h"
#include "edge/program/edge_clock.h"
#include "edge/program/find_battery.h"
#include "edge/settings/edge_config.h"
#include "edge/storage/recall.h"

namespace bess {

/// Time zone, signals and timers of the process; before any thread is started.
void prepare_process();

/// True when it is found; otherwise one line on stderr says what to mend.
bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock);

/// Of the sign check's copies: each that was lost or damaged is a line of the journal, and written
/// again.
void report_commission_losses(const EdgeConfig& config);

/// What earlier runs left. Where that cannot be read, a journal line says why, and the battery is
/// not driven until a person clears it.
/// `published_number`: recall.h.
Recall recall_at_start(const EdgeConfig& config, const EventLog& log,
                       std::uint64_t published_number);

/// One journal line: whether the guard enforces what the student is proved for.
void journal_thresholds(const EdgeConfig& config);

/// One journal line where others than the price server could write the prices.
void journal_transport(const EdgeConfig& config);

/// What the signature command prints of this build.
std::string decision_signature_line();

/// True when this machine computes the built-in student as the exporter did.
bool check_student();

}  // namespace bess
