#include "workstation/runs/chain/chain_steps.h"

#include <fmt/core.h>

#include <filesystem>

#include "shared/crc32.h"
#include "shared/utc_text.h"
#include "workstation/correction/student/prove.h"

namespace bess {

std::uint32_t prices_checksum(const MinuteSeries& series) {
  Crc32 prices;
  prices.add_bytes(series.indicative.data(), sizeof(double) * series.size());
  prices.add_bytes(series.settled.data(), sizeof(double) * series.size());
  return prices.value();
}

std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result) {
  std::string text =
      fmt::format("bess-train {} {} on {}, by {}", BESS_VERSION, method_name(options.method),
                  std::filesystem::path(prices).filename().string(), context_name(options.context));
  if (options.method == Method::kSdp) return text;  // deterministic, without steps
  if (options.residual) {
    text += fmt::format(" on the stochastic program, {} atoms to +-{:.0f} EUR/h", options.atoms,
                        double{result.teacher.support.v_max} / double{kRewardScale});
  }
  return fmt::format("{}, seed {}, kept at step {} of {}", text, options.seed, result.best_step,
                     options.steps);
}

void warn_narrow_support(const TrainOptions& options, const TrainResult& result) {
  constexpr double kEdgeMassMax = 0.01;
  constexpr double kResidualEdgeMassMax = 0.005;  // its support is measured, not configured
  if (options.method != Method::kC51 || result.curve.empty()) return;
  const double edge_mass_frac = result.curve.back().edge_mass_frac;
  if (edge_mass_frac <= (options.residual ? kResidualEdgeMassMax : kEdgeMassMax)) return;
  fmt::print(stderr,
             "bess-train: warning: {:.1f} % of the value distribution is on the end atoms; {}\n",
             100 * edge_mass_frac,
             options.residual ? "lower [train] residual_gamma"
                              : "widen [train] value_min_eur_per_h and value_max_eur_per_h");
}

std::string prices_hash(const MinuteSeries& series, const UtcSpan& part) {
  return fmt::format("crc32 {:08x}, {} minutes from {}", prices_checksum(series),
                     (part.until_s - part.from_s) / 60, utc_text(part.from_s).view());
}

std::string prices_hash(const MinuteSeries& series) {
  return prices_hash(series, {series.start_utc_s, series.utc_s(series.size())});
}

const ProvedStudent& require_proof(const CorrectionResult& result, CorrectionMethod method,
                                   const std::string& where, const std::string& note) {
  if (const auto* proved = std::get_if<ProvedStudent>(&result.verdict)) return *proved;
  throw ProofFailed(
      describe_failed_proof(student_of(result.verdict), result.rounds, method, where, note));
}

}  // namespace bess
