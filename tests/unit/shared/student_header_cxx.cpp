// The exported header is C++ as well, and its hashes are those of the arrays: exported_student.h
// asserts it at compile time.
#include "shared/nn/exported_student.h"
#include "student_header_check.h"

int main() { return check_student_header() + bess::count_exported_self_check_failures(); }
