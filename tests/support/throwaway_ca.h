// A certificate authority that lives as long as a test, and a server certificate for one name.
#pragma once

#include <string>

#include "shared/host/child_process.h"
#include "tests/support/temporary_folder.h"

namespace bess {

class ThrowawayCa {
 public:
  explicit ThrowawayCa(const std::string& server_name) {
    make({"-subj", "/CN=throw-away CA", "-keyout", file("ca.key"), "-out", ca()});
    make({"-subj", "/CN=server", "-keyout", key(), "-out", certificate(), "-CA", ca(), "-CAkey",
          file("ca.key"), "-addext", "subjectAltName=" + server_name, "-addext",
          "basicConstraints=CA:FALSE"});
  }
  [[nodiscard]] std::string ca() const { return file("ca.pem"); }
  [[nodiscard]] std::string certificate() const { return file("server.pem"); }
  [[nodiscard]] std::string key() const { return file("server.key"); }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

 private:
  static void make(const std::vector<std::string>& rest) {
    std::vector<std::string> arguments = {
        "/usr/bin/openssl",        "req",    "-x509", "-newkey", "ec", "-pkeyopt",
        "ec_paramgen_curve:P-256", "-nodes", "-days", "2"};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    ChildProcess openssl(arguments);
    openssl.read_all();
    openssl.wait();
  }

  TemporaryFolder folder_;
};

}  // namespace bess
