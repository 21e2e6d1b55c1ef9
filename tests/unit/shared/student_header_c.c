/* The exported header is C11. */
#include "student_header_check.h"

int main(void) { return check_student_header(); }
