#include "tests/support/fake_resolver.h"

#include <arpa/inet.h>
#include <netdb.h>

#include <cstdlib>
#include <map>
#include <mutex>

namespace bess::fake_resolver {
namespace {

std::mutex mutex;
std::map<std::string, std::vector<std::string>> names;

struct Entry {
  addrinfo info;
  sockaddr_storage address;
};

addrinfo* make_entry(const std::string& numeric, std::uint16_t port, addrinfo* next) {
  auto* entry = static_cast<Entry*>(std::calloc(1, sizeof(Entry)));
  auto* v4 = reinterpret_cast<sockaddr_in*>(&entry->address);
  auto* v6 = reinterpret_cast<sockaddr_in6*>(&entry->address);
  const bool is_v4 = inet_pton(AF_INET, numeric.c_str(), &v4->sin_addr) == 1;
  if (!is_v4) inet_pton(AF_INET6, numeric.c_str(), &v6->sin6_addr);
  entry->address.ss_family = is_v4 ? AF_INET : AF_INET6;
  (is_v4 ? v4->sin_port : v6->sin6_port) = htons(port);
  entry->info.ai_family = entry->address.ss_family;
  entry->info.ai_socktype = SOCK_STREAM;
  entry->info.ai_addrlen = is_v4 ? sizeof *v4 : sizeof *v6;
  entry->info.ai_addr = reinterpret_cast<sockaddr*>(&entry->address);
  entry->info.ai_next = next;
  return &entry->info;
}

int look_up(const char* name, const char* service, addrinfo** found) {
  const std::lock_guard lock(mutex);
  const std::vector<std::string>& addresses = names[name];
  *found = nullptr;
  const auto port = static_cast<std::uint16_t>(service == nullptr ? 0 : std::atoi(service));
  for (auto it = addresses.rbegin(); it != addresses.rend(); ++it) {
    *found = make_entry(*it, port, *found);
  }
  return *found == nullptr ? EAI_AGAIN : 0;
}

}  // namespace

void set(const std::string& name, const std::vector<std::string>& addresses) {
  const std::lock_guard lock(mutex);
  names[name] = addresses;
}

}  // namespace bess::fake_resolver

extern "C" int getaddrinfo(const char* name, const char* service, const addrinfo*,
                           addrinfo** found) {
  return bess::fake_resolver::look_up(name == nullptr ? "" : name, service, found);
}

extern "C" void freeaddrinfo(addrinfo* found) {
  while (found != nullptr) {
    addrinfo* next = found->ai_next;
    std::free(found);  // the entry's first member
    found = next;
  }
}
