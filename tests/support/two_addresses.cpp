// Preloaded name lookup: two-addresses.test has ::1 and 127.0.0.1, in this order, like a host with
// IPv6 and IPv4. The C library resolves every other name.
#include <dlfcn.h>
#include <netdb.h>

#include <cstring>

extern "C" int getaddrinfo(const char* name, const char* service, const addrinfo* hints,
                           addrinfo** found) {
  using Resolve = int (*)(const char*, const char*, const addrinfo*, addrinfo**);
  static const auto resolve = reinterpret_cast<Resolve>(dlsym(RTLD_NEXT, "getaddrinfo"));
  if (name == nullptr || std::strcmp(name, "two-addresses.test") != 0) {
    return resolve(name, service, hints, found);
  }
  const int status = resolve("::1", service, hints, found);
  if (status != 0) return status;
  addrinfo* last = *found;
  while (last->ai_next != nullptr) last = last->ai_next;
  return resolve("127.0.0.1", service, hints, &last->ai_next);
}
