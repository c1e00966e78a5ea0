#pragma once

/// The exported C program in pieces; c_parts.hpp says what $ marks. It is filter/step/equations in C, name by name:
/// tests/app/export/c_filter_test.cpp holds the two together.
namespace modebank::app::c_form {

extern const char *const steps_repeat, *const steps_single, *const samples_text;   // sample_feed.hpp
extern const char *const algebra_text, *const kalman_text, *const input_term;      // arithmetic.hpp, kalman.hpp
extern const char *const transition_at, *const with_logit;                         // transition_logit.hpp
extern const char *const no_mixing, *const mixing_weights, *const mix_imm;         // imm.hpp
extern const char *const probabilities_text, *const noise_text, *const step_text;  // imm.hpp, noise_scale.hpp

}  // namespace modebank::app::c_form
