// Certificate authority and server certificate with arbitrary dates, made in memory and written as
// PEM.
#pragma once

#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <string>

#include "tests/support/temporary_folder.h"

namespace bess {

class DatedCertificate {
 public:
  /// Valid from `from_s` to `to_s` seconds from now; `name` is a subjectAltName ("IP:127.0.0.1").
  explicit DatedCertificate(const std::string& name, long from_s = -kDayS, long to_s = kDayS,
                            const char* ca_name = "throw-away CA")
      : ca_key_(EVP_EC_gen("P-256")), key_(EVP_EC_gen("P-256")) {
    X509* const ca = make(ca_name, -kDayS, 2 * kDayS, nullptr, ca_key_);
    extend(ca, ca, NID_basic_constraints, "critical,CA:TRUE");
    X509_sign(ca, ca_key_, EVP_sha256());
    X509* const server = make("server", from_s, to_s, ca, key_);
    extend(server, ca, NID_subject_alt_name, name);
    X509_sign(server, ca_key_, EVP_sha256());
    write(this->ca(), ca);
    write(certificate(), server);
    std::FILE* const file = std::fopen(key().c_str(), "w");
    PEM_write_PrivateKey(file, key_, nullptr, nullptr, 0, nullptr, nullptr);
    std::fclose(file);
    X509_free(ca);
    X509_free(server);
  }
  DatedCertificate(const DatedCertificate&) = delete;
  DatedCertificate& operator=(const DatedCertificate&) = delete;
  ~DatedCertificate() {
    EVP_PKEY_free(ca_key_);
    EVP_PKEY_free(key_);
  }
  [[nodiscard]] std::string ca() const { return folder_.file("ca.pem"); }
  [[nodiscard]] std::string certificate() const { return folder_.file("server.pem"); }
  [[nodiscard]] std::string key() const { return folder_.file("server.key"); }

  static constexpr long kDayS = 86'400;

 private:
  static X509* make(const char* name, long from_s, long to_s, const X509* issuer, EVP_PKEY* key) {
    X509* const made = X509_new();
    X509_set_version(made, X509_VERSION_3);
    ASN1_INTEGER_set(X509_get_serialNumber(made), issuer == nullptr ? 1 : 2);
    X509_gmtime_adj(X509_getm_notBefore(made), from_s);
    X509_gmtime_adj(X509_getm_notAfter(made), to_s);
    X509_NAME* const subject = X509_get_subject_name(made);
    X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>(name), -1, -1, 0);
    X509_set_issuer_name(made, issuer == nullptr ? subject : X509_get_subject_name(issuer));
    X509_set_pubkey(made, key);
    return made;
  }
  static void extend(X509* certificate, X509* issuer, int what, const std::string& value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, &context, what, value.c_str());
    X509_add_ext(certificate, extension, -1);
    X509_EXTENSION_free(extension);
  }
  static void write(const std::string& path, X509* certificate) {
    std::FILE* const file = std::fopen(path.c_str(), "w");
    PEM_write_X509(file, certificate);
    std::fclose(file);
  }

  TemporaryFolder folder_;
  EVP_PKEY* ca_key_;
  EVP_PKEY* key_;
};

}  // namespace bess
