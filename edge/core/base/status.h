// Outcome of anything that touches the outside world (bus, prices, files). It is returned, never
// thrown, and handled at the tick: the answer to a bad status is a mode, not an exception.
#pragma once

#include <cstdint>
#include <iterator>
#include <string_view>

namespace bess {

enum class [[nodiscard]] Status : std::uint8_t{
    kOk,
    kNotConnected,    ///< nobody listens, or the connection was closed
    kTimeout,         ///< no answer, or no complete answer, in time
    kBusException,    ///< the battery answered with a Modbus exception that a retry does not mend
    kBusBusy,         ///< the battery answered that it is busy (exception 5 or 6): worth a retry
    kNotPermitted,    ///< the battery answered that this client may not do this
    kBadReply,        ///< an answer that does not belong to the question
    kImplausible,     ///< a value outside the range that its register map or the market allows
    kNotApplied,      ///< acknowledged, but the read-back shows other values
    kNotExpressible,  ///< the register map cannot express the order
    kWriteBudget,     ///< registers in flash memory have had their writes of the day
    kNameUnresolved,  ///< the price server's name has no address, or no name server answers
    kTlsRefused,      ///< no trusted TLS connection to the price server
    kHttpError,       ///< the price server answered, but not with 200
    kMalformed,       ///< the price server's answer is not what the configuration describes
    kNoRow,           ///< a good answer without any usable price
    kTooLarge,        ///< more bytes than the fixed buffer holds
    kNoMemory,        ///< of earlier versions
    kTooLate,         ///< an order was not written, because its time was over
    kServerBusy,      ///< the price server asks for fewer requests (429, 503)
    kNoFetcher,       ///< bess-prices does not run, or has been silent for cycles
    kOtherVersion,    ///< what bess-prices publishes is of another version
    kDoubtfulUnit,    ///< prices as small, or as large, as in another unit
};

inline constexpr int kStatusCount = static_cast<int>(Status::kDoubtfulUnit) + 1;

/// Trouble of the link or a busy device, which may pass within seconds; any other the same request
/// would meet again.
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

/// What it means and what mends it, for the one line that a user reads.
constexpr std::string_view status_text(Status status) {
  constexpr std::string_view kTexts[] = {
      "ok",
      "no connection (are host and port right, is it running, does it serve one client only?)",
      "no answer in time (is the unit id right?)",
      "answered with a Modbus exception (does the register map fit this model?)",
      "answered that it is busy",
      "answered that this client may not do this (is external control enabled on the device?)",
      "answered with something that does not belong to the question",
      "delivered a value outside its plausible range",
      "acknowledged an order but did not keep it",
      "the register map cannot express this order",
      "registers in flash memory have had their writes of the day (see the map's write budget)",
      "the price server's name cannot be resolved (is the name server reachable?)",
      "no trusted TLS connection to the price server (are ca_file and the clock right?)",
      "the price server answered with an HTTP error (are url and the key in header_file right?)",
      "the price server's answer is not the JSON that [price] describes (is rows_field right?)",
      "the price server's answer holds no usable price (are time_field and price_field right?)",
      "the answer is larger than the buffer",
      "no memory",
      "an order was not written, because its time was over (was this process stopped?)",
      "the price server asks for fewer requests",
      "bess-prices does not run, or publishes nothing (systemctl status bess-prices)",
      "bess-prices is of another version (restart it)",
      "the prices look like another unit (are they in EUR/MWh? see [price] unit)"};
  static_assert(std::size(kTexts) == kStatusCount);
  return kTexts[static_cast<int>(status)];
}

}  // namespace bess
