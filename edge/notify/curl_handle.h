// What libcurl makes, given back at its end.
#pragma once

#include <curl/curl.h>

#include <memory>

namespace bess {

template <auto kFree>
struct FreeWith {
  template <typename T>
  void operator()(T* held) const {
    kFree(held);
  }
};

using Curl = std::unique_ptr<CURL, FreeWith<curl_easy_cleanup>>;
using CurlList = std::unique_ptr<curl_slist, FreeWith<curl_slist_free_all>>;
using CurlUrl = std::unique_ptr<CURLU, FreeWith<curl_url_cleanup>>;
using CurlText = std::unique_ptr<char, FreeWith<curl_free>>;

}  // namespace bess
