// Run folder: file names of one run of the whole chain.
#pragma once

#include <filesystem>
#include <string>

#include "workstation/runs/chain/run_config.h"

namespace bess {

namespace run_file {
inline constexpr const char* kRecord = "run.json";
inline constexpr const char* kTimes = "times.json";
inline constexpr const char* kConfig = "config.toml";
inline constexpr const char* kSimulatedPrices = "prices.csv.gz";
inline constexpr const char* kTeacher = "teacher.bin";
inline constexpr const char* kCheckpoint = "teacher.checkpoint";
inline constexpr const char* kTrainingCurve = "training_curve.csv";
inline constexpr const char* kPlainStudent = "student_plain.json";
inline constexpr const char* kPlainViolations = "student_plain_violations.csv";
inline constexpr const char* kStudent = "student.json";
inline constexpr const char* kUnprovedStudent = "student_unproved.json";
inline constexpr const char* kUnprovedViolations = "student_unproved_violations.csv";
inline constexpr const char* kDistilCurve = "distil_curve.csv";
inline constexpr const char* kProofRounds = "proof_rounds.csv";
inline constexpr const char* kCheckpoints = "student_checkpoints.csv";
inline constexpr const char* kHeader = "student_weights.h";
inline constexpr const char* kTable = "evaluation.csv";
inline constexpr const char* kDays = "evaluation_days.csv";
inline constexpr const char* kSummary = "summary.txt";
inline constexpr const char* kReport = "report.html";
}  // namespace run_file

struct RunFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path / name; }
  [[nodiscard]] std::filesystem::path record() const { return file(run_file::kRecord); }
};

}  // namespace bess
