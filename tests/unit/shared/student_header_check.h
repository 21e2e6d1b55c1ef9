/* Reads an exported student_weights.h as plain C and as C++, and answers its self-check vectors
   with a second, independent evaluation of the net (64-bit sums, one loop a layer). Prints the
   number of vectors; the exit code is the number of wrong ones. */
#ifndef BESS_TESTS_SHARED_STUDENT_HEADER_CHECK_H
#define BESS_TESTS_SHARED_STUDENT_HEADER_CHECK_H

#include <stdint.h>
#include <stdio.h>
#include <student_weights.h>

enum { kTestHidden1 = 64, kTestHidden2 = 32, kTestActions = 3, kTestPriceMin = -500 };

/* round(x / 2^shift), halves up, without shifting a negative number; then 0 .. 32767. */
static int64_t test_rescale(int64_t x, int32_t shift) {
  const int64_t unit = (int64_t)1 << shift;
  const int64_t shifted = x + unit / 2;
  if (shifted < 0) return 0;
  return shifted / unit > 32767 ? 32767 : shifted / unit;
}

static int test_vector_is_wrong(int index) {
  const int16_t* state = bess_student_self_check_state[index];
  const int64_t x[5] = {(int64_t)state[0] * (16384 / 14), (int64_t)state[1] * (16384 / 95),
                        (int64_t)(state[2] - 1) * (16384 / 11), (int64_t)state[3] * (16384 / 200),
                        bess_student_price_map[state[4] - kTestPriceMin]};
  int64_t hidden1[kTestHidden1];
  int64_t hidden2[kTestHidden2];
  int wrong = 0;
  for (int o = 0; o < kTestHidden1; ++o) {
    int64_t sum = bess_student_layer1_bias[o];
    for (int i = 0; i < 5; ++i) sum += bess_student_layer1_weight[i][o] * x[i];
    hidden1[o] = test_rescale(sum, bess_student_relu1_shift);
  }
  for (int o = 0; o < kTestHidden2; ++o) {
    int64_t sum = bess_student_layer2_bias[o];
    for (int i = 0; i < kTestHidden1; ++i) sum += bess_student_layer2_weight[i][o] * hidden1[i];
    hidden2[o] = test_rescale(sum, bess_student_relu2_shift);
  }
  for (int a = 0; a < kTestActions; ++a) {
    int64_t sum = bess_student_layer3_bias[a];
    for (int i = 0; i < kTestHidden2; ++i) sum += bess_student_layer3_weight[i][a] * hidden2[i];
    if (sum != bess_student_self_check_logits[index][a]) wrong = 1;
  }
  return wrong;
}

static int check_student_header(void) {
  int wrong = 0;
  for (int i = 0; i < BESS_STUDENT_SELF_CHECK_COUNT; ++i) wrong += test_vector_is_wrong(i);
  printf("%d self-check vectors, %d wrong; provenance: %s\n", BESS_STUDENT_SELF_CHECK_COUNT, wrong,
         BESS_STUDENT_PROVENANCE);
  return wrong;
}

#endif
