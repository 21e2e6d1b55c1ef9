// Status: outcome of an operation on the outside world (bus, prices, files). It is returned, never
// thrown. A bad status at a tick leads to a mode, not an exception.
#pragma once

#include <cstdint>
#include <iterator>
#include <string_view>

namespace bess {

/// Logged by value: new ones are appended.
enum class [[nodiscard]] Status : std::uint8_t{
    kOk,
    kNotConnected,    ///< connection refused or closed
    kTimeout,         ///< no complete answer in time
    kBusException,    ///< the battery answered with a Modbus exception that a retry does not cure
    kBusBusy,         ///< the battery is busy (exception 5 or 6): worth a retry
    kNotPermitted,    ///< the battery does not permit this client to do this
    kBadReply,        ///< a reply that does not match the request
    kImplausible,     ///< a value outside the range that its register map or the market allows
    kNotApplied,      ///< acknowledged, but the read-back shows other values
    kNotExpressible,  ///< the register map cannot express the order
    kWriteBudget,     ///< daily write limit of flash registers reached
    kNameUnresolved,  ///< the price server's name has no address, or no name server answers
    kTlsRefused,      ///< no trusted TLS connection to the price server
    kHttpError,       ///< the price server answered, but not with 200
    kMalformed,       ///< the price server's answer does not match the configuration
    kNoRow,           ///< a valid answer without a usable price
    kTooLarge,        ///< more bytes than the fixed buffer holds
    kNoMemory,        ///< written by earlier versions only
    kTooLate,         ///< order expired before it was written
    kServerBusy,      ///< rate limited by the price server (429, 503)
    kNoFetcher,       ///< bess-prices is not running, or silent for several control cycles
    kOtherVersion,    ///< the published price file has another version
    kDoubtfulUnit,    ///< prices of a magnitude that suggests another unit
};

inline constexpr int kStatusCount = static_cast<int>(Status::kDoubtfulUnit) + 1;

/// Link failure or busy device, which may clear within seconds. Any other status would recur.
constexpr bool is_temporary(Status status) {
  return status == Status::kNotConnected || status == Status::kTimeout ||
         status == Status::kBusBusy || status == Status::kBadReply;
}

constexpr std::string_view status_name(Status status) {
  constexpr std::string_view kNames[] = {
      "ok",          "not_connected",   "timeout",      "bus_exception",
      "bus_busy",    "not_permitted",   "bad_reply",    "implausible",
      "not_applied", "not_expressible", "write_budget", "name_unresolved",
      "tls_refused", "http_error",      "malformed",    "no_row",
      "too_large",   "no_memory",       "too_late",     "server_busy",
      "no_fetcher",  "other_version",   "doubtful_unit"};
  static_assert(std::size(kNames) == kStatusCount);
  return kNames[static_cast<int>(status)];
}

/// Meaning and remedy, for the one line that a user reads.
constexpr std::string_view status_text(Status status) {
  constexpr std::string_view kTexts[] = {
      "ok",
      "no connection (check host and port; is it running? does it serve only one client?)",
      "timeout (check the unit id)",
      "Modbus exception (check that the register map fits this model)",
      "device busy",
      "not permitted (enable external control on the device)",
      "invalid reply (does not match the request)",
      "value outside its plausible range",
      "order acknowledged but not applied (read-back differs)",
      "the register map cannot express this order",
      "daily write limit of flash registers reached (see the map's write budget)",
      "cannot resolve the name of the price server (check the name server)",
      "no trusted TLS connection to the price server (check ca_file and the clock)",
      "HTTP error from the price server (check url and the key in header_file)",
      "answer of the price server is not the JSON that [price] describes (check rows_field)",
      "no usable price in the answer of the price server (check time_field and price_field)",
      "answer larger than the buffer",
      "no memory",
      "order expired before it was written (was the process stopped?)",
      "rate limited by the price server",
      "bess-prices is not running or publishes nothing (systemctl status bess-prices)",
      "bess-prices has another version (restart it)",
      "prices look like another unit (are they in EUR/MWh? see [price] unit)"};
  static_assert(std::size(kTexts) == kStatusCount);
  return kTexts[static_cast<int>(status)];
}

}  // namespace bess
