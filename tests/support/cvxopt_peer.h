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

  /// One solution per program; nothing if cvxopt is missing.
  [[nodiscard]] std::optional<std::vector<Eigen::VectorXd>> solve() const {
    if (!run(folder_.file("answers"), {})) return {};
    std::ifstream file(folder_.file("answers"), std::ios::binary);
    std::vector<Eigen::VectorXd> answers;
    for (const TestProgram& program : programs_) {
      Eigen::VectorXd& x = answers.emplace_back(program.g.size());
      file.read(reinterpret_cast<char*>(x.data()),
                static_cast<std::streamsize>(sizeof(double)) * x.size());
    }
    if (!file) return {};
    return answers;
  }

  /// Median CPU microseconds of each program; nothing if cvxopt is missing.
  [[nodiscard]] std::optional<std::vector<double>> median_us(int repetitions) const {
    const std::optional<std::string> printed = run("--time", std::to_string(repetitions));
    if (!printed) return {};
    std::istringstream lines(*printed);
    std::vector<double> times;
    for (double us = 0; lines >> us;) times.push_back(us);
    if (times.size() != programs_.size()) return {};
    return times;
  }

 private:
  /// Output of the script; throws when it fails.
  [[nodiscard]] std::optional<std::string> run(const std::string& what,
                                               const std::string& count) const {
    std::vector<std::string> words{"/usr/bin/python3",
                                   BESS_SOURCE_DIR "/tests/support/qp_cvxopt.py",
                                   folder_.file("programs"), what};
    if (!count.empty()) words.push_back(count);
    ChildProcess peer(words);
    const std::string printed = peer.read_all();
    const int code = peer.wait();
    if (code == kMissing) return {};
    if (code != 0) throw std::runtime_error(printed);
    return printed;
  }

  static constexpr int kMissing = 77;  ///< qp_cvxopt.py's exit code without cvxopt
  const std::vector<TestProgram>& programs_;
  TemporaryFolder folder_;
};

}  // namespace bess
