#!/bin/sh
# no_allocator.sh NM "NAME..." FILE...: fails, naming object and symbol, if an object NAME.cpp.o in
# the archives or objects FILE refers to an allocator, to a function of the C library that calls
# one, to an exception, or to a std class that owns memory. Fails as well if a NAME is in no FILE,
# so that a rename is noticed. std::__throw_system_error is allowed: std::mutex uses it for a broken
# mutex.
nm=$1 names=$2
shift 2
status=0
symbols=$(for file in "$@"; do "$nm" -A -C "$file"; done)

c_library='malloc|calloc|realloc|reallocarray|free|aligned_alloc|posix_memalign|memalign|valloc|pvalloc'
c_library="$c_library|v?asprintf|v?dprintf|strn?dup|fopen|fdopen|fopen64|opendir|getline|getdelim|qsort|getaddrinfo"
c_library="$c_library|localtime|mktime|tzalloc|setlocale|dlopen|printf|vprintf|fprintf|puts|fwrite"
cxx='operator (new|delete)|__cxa_throw|__cxa_allocate_exception|std::__throw_|std::thread::'
cxx="$cxx|std::(__cxx11::)?basic_string<|std::function<|std::_Function_base|std::bad_function_call|std::pmr::"
for name in $names; do
  own=$(printf '%s\n' "$symbols" | grep -E "(^|[:/])$name\.cpp\.o:")
  if [ -z "$own" ]; then
    echo "$name.cpp.o is in none of the files: was it renamed?"
    status=1
    continue
  fi
  found=$(printf '%s\n' "$own" |
    grep -E " U ($c_library)(@.*)?\$| [A-Za-z] .*($cxx)" | grep -v 'std::__throw_system_error')
  if [ -n "$found" ]; then
    echo "$name.cpp.o may allocate:"
    printf '%s\n' "$found"
    status=1
  fi
done
exit $status
