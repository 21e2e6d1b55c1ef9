// Peer solver cvxopt on the same quadratic programs (qp_cvxopt.py), if python3-cvxopt is installed.
#pragma once

#include <array>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "tests/support/random_programs.h"
#include "tests/support/temporary_folder.h"

namespace bess {

class CvxoptPeer {
 public:
  explicit CvxoptPeer(const std::vector<TestProgram>& programs) : programs_(programs) {
    std::ofstream file(folder_.file("programs"), std::ios::binary);
    const auto put = [&](const auto* numbers, std::size_t count) {
      file.write(reinterpret_cast<const char*>(numbers),
                 static_cast<std::streamsize>(count * sizeof *numbers));
    };
    const std::int64_t count = static_cast<std::int64_t>(programs.size());
    put(&count, 1);
    for (const TestProgram& program : programs) {
      const auto& [normals, bounds] = program.constraints;
      std::vector<std::int64_t> rows, columns;
      std::vector<double> factors;
      for (int i = 0; i < normals.rows(); ++i) {
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator t(normals, i); t; ++t) {
          rows.push_back(i);
          columns.push_back(t.col());
          factors.push_back(t.value());
        }
      }
      const std::array<std::int64_t, 3> head{normals.cols(), normals.rows(),
                                             static_cast<std::int64_t>(factors.size())};
      put(head.data(), head.size());
      put(program.g.data(), static_cast<std::size_t>(program.g.size()));
      put(rows.data(), rows.size());
      put(columns.data(), columns.size());
      put(factors.data(), factors.size());
      put(bounds.data(), static_cast<std::size_t>(bounds.size()));
    }
  }

  /// Median CPU microseconds of each program; nothing if cvxopt is missing; throws when it fails.
  [[nodiscard]] std::optional<std::vector<double>> median_us(int repetitions) const {
    ChildProcess peer({"/usr/bin/python3", BESS_SOURCE_DIR "/tests/support/qp_cvxopt.py",
                       folder_.file("programs"), std::to_string(repetitions)});
    const std::string printed = peer.read_all();
    const int code = peer.wait();
    if (code == kMissing) return {};
    if (code != 0) throw std::runtime_error(printed);
    std::istringstream lines(printed);
    std::vector<double> times;
    for (double us = 0; lines >> us;) times.push_back(us);
    if (times.size() != programs_.size()) return {};
    return times;
  }

 private:
  static constexpr int kMissing = 77;  ///< qp_cvxopt.py's exit code without cvxopt
  const std::vector<TestProgram>& programs_;
  TemporaryFolder folder_;
};

}  // namespace bess
