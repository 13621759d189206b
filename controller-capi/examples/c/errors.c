/* Every error of the interface, called; ends with 1 where an answer is wrong. */
#include "board.h"
#include "stratum.h"

#include <stdint.h>

static StratumController controller, other, blank_controller;
static StratumState state, blank_state;
static StratumSettings settings;
static StratumArm arm;
static StratumReference reference;
static StratumStatus status;
static double q[7] = {0.0, 0.5, 0.0, -1.5, 0.5, 1.0, 0.0}, dq[7], torque[7], bad[7];
static char text[STRATUM_TEXT_SIZE];
static _Alignas(8) unsigned char bytes[sizeof(StratumController) + 8];
static int wrong, expected;

static void expect(const char *what, StratumResult result, StratumResult wanted) {
    expected++;
    if (result == wanted) return;
    wrong++;
    board_print(what);
    board_print("\n  answers ");
    board_print(stratum_error_name(result));
    board_print(", not ");
    board_print(stratum_error_name(wanted));
    board_print("\n");
}
#define EXPECT(wanted, call) expect(#call, call, wanted)
#define CHECK(condition) expect(#condition, (condition) ? STRATUM_OK : 1, STRATUM_OK)

/* A pointer that is aligned for nothing. */
#define ODD(type) ((type *)(void *)(bytes + 1))

static void fresh(void) {
    EXPECT(STRATUM_OK, stratum_settings_default(STRATUM_ABI_VERSION, &settings));
}

/* The settings are refused, by both functions alike and with a text that fits. */
static void refused(StratumResult wanted) {
    EXPECT(wanted, stratum_settings_text(&settings, text, sizeof text));
    EXPECT(wanted, stratum_controller_init(&other, &settings));
    CHECK(text[0] != 0 && text[sizeof text - 2] == 0);
    board_print(stratum_error_name(wanted));
    board_print(": ");
    board_print(text);
    board_print("\n");
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_state_init(&blank_state, &other, q));
    fresh();
}
#define REFUSED(wanted, change) do { change; refused(wanted); } while (0)

static void arguments(void) {
    const double infinite = 1.0 / (double)(dq[0] * dq[0]);
    for (int i = 0; i < 7; i++) bad[i] = infinite;

    EXPECT(STRATUM_ERROR_ABI, stratum_settings_default(STRATUM_ABI_VERSION + 1, &settings));
    EXPECT(STRATUM_ERROR_ABI, stratum_settings_default(1, &settings));
    EXPECT(STRATUM_ERROR_NULL, stratum_settings_default(STRATUM_ABI_VERSION, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED,
           stratum_settings_default(STRATUM_ABI_VERSION, ODD(StratumSettings)));
    EXPECT(STRATUM_ERROR_ABI, stratum_settings_of_arm(1, "fr3", &settings));
    EXPECT(STRATUM_ERROR_PRESET, stratum_settings_of_arm(STRATUM_ABI_VERSION, "", &settings));
    EXPECT(STRATUM_ERROR_NULL, stratum_settings_of_arm(STRATUM_ABI_VERSION, 0, &settings));
    EXPECT(STRATUM_ERROR_NULL, stratum_settings_of_arm(STRATUM_ABI_VERSION, "fr3", 0));
    EXPECT(STRATUM_ERROR_MISALIGNED,
           stratum_settings_of_arm(STRATUM_ABI_VERSION, "fr3", ODD(StratumSettings)));
    EXPECT(STRATUM_OK, stratum_settings_of_arm(STRATUM_ABI_VERSION, "openarm_v20_left", &settings));
    CHECK(settings.arm.name[16] == 0 && settings.arm.links[3].rotor_inertia > 0.0);
    EXPECT(STRATUM_OK, stratum_controller_init(&other, &settings));
    EXPECT(STRATUM_OK, stratum_arm_preset("panda_identified", &arm));
    EXPECT(STRATUM_OK, stratum_arm_preset("lwr_iv", &arm));
    EXPECT(STRATUM_ERROR_PRESET, stratum_arm_preset("lwr", &arm));
    EXPECT(STRATUM_ERROR_PRESET, stratum_arm_preset("lwr_iv+", &arm));
    EXPECT(STRATUM_ERROR_NULL, stratum_arm_preset(0, &arm));
    EXPECT(STRATUM_ERROR_NULL, stratum_arm_preset("lwr_iv", 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_arm_preset("lwr_iv", ODD(StratumArm)));

    fresh();
    EXPECT(STRATUM_OK, stratum_settings_text(&settings, text, sizeof text));
    CHECK(text[0] == 0);
    EXPECT(STRATUM_ERROR_NULL, stratum_settings_text(0, text, sizeof text));
    EXPECT(STRATUM_ERROR_NULL, stratum_settings_text(&settings, 0, sizeof text));
    EXPECT(STRATUM_ERROR_TEXT_SIZE, stratum_settings_text(&settings, text, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED,
           stratum_settings_text(ODD(StratumSettings), text, sizeof text));
    EXPECT(STRATUM_ERROR_NULL, stratum_controller_init(0, &settings));
    EXPECT(STRATUM_ERROR_NULL, stratum_controller_init(&controller, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_controller_init(ODD(StratumController), &settings));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_controller_init(&controller, ODD(StratumSettings)));
    EXPECT(STRATUM_OK, stratum_controller_init(&controller, &settings));

    EXPECT(STRATUM_ERROR_NULL, stratum_state_init(0, &controller, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_state_init(&state, 0, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_state_init(&state, &controller, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_state_init(ODD(StratumState), &controller, q));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_state_init(&state, ODD(StratumController), q));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_state_init(&state, &controller, ODD(double)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_state_init(&state, &blank_controller, q));
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_state_init(&state, &controller, bad));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_skip(&state)); /* emptied by the errors */
    EXPECT(STRATUM_OK, stratum_state_init(&state, &controller, q));
}

static void references(void) {
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_get(0, 1, &reference));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_get(&state, 1, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_get(ODD(StratumState), 1, &reference));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_get(&state, 1, ODD(StratumReference)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_reference_get(&blank_state, 1, &reference));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_reference_get(&state, 0, &reference));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_reference_get(&state, 2, &reference));
    EXPECT(STRATUM_OK, stratum_reference_get(&state, 1, &reference));

    EXPECT(STRATUM_OK, stratum_reference_set(&state, 1, &reference));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_set(0, 1, &reference));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_set(&state, 1, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_set(ODD(StratumState), 1, &reference));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_set(&state, 1, ODD(StratumReference)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_reference_set(&blank_state, 1, &reference));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_reference_set(&state, 0, &reference));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_reference_set(&state, 0xffffffffu, &reference));
    StratumReference changed = reference;
    changed.x[1] = bad[0];
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_set(&state, 1, &changed));
    changed = reference;
    changed.dx[2] = -bad[0];
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_set(&state, 1, &changed));
    changed = reference;
    changed.ddx[0] = bad[0] - bad[0];
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_set(&state, 1, &changed));
    changed = reference;
    changed.orientation[3] = bad[0];
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_set(&state, 1, &changed));
    changed = reference;
    changed.reserved = 1;
    EXPECT(STRATUM_ERROR_TARGET, stratum_reference_set(&state, 1, &changed));
    changed = reference;
    changed.kind = 3;
    EXPECT(STRATUM_ERROR_TARGET, stratum_reference_set(&state, 1, &changed));
    changed.kind = STRATUM_TARGET_HOLD; /* as from a program that knows no kinds */
    EXPECT(STRATUM_ERROR_TARGET, stratum_reference_set(&state, 1, &changed));
    StratumReference filled = {.x = {-0.5, 0.1, 0.4}, .orientation = {1.0, 0.0, 0.0, 0.0}};
    EXPECT(STRATUM_ERROR_TARGET, stratum_reference_set(&state, 1, &filled));
    changed.kind = STRATUM_TARGET_ORIENTATION;
    changed.orientation[0] = 2.1;
    EXPECT(STRATUM_ERROR_ORIENTATION, stratum_reference_set(&state, 1, &changed));
    changed.orientation[0] = 1.0;
    EXPECT(STRATUM_ERROR_WRONG_TARGET, stratum_reference_set(&state, 1, &changed));
    EXPECT(STRATUM_OK, stratum_reference_get(&state, 1, &changed));
    CHECK(changed.kind == STRATUM_TARGET_POSITION && changed.x[2] == reference.x[2]);
    StratumReference hold = {0};
    EXPECT(STRATUM_OK, stratum_reference_set(&state, 1, &hold));
    EXPECT(STRATUM_OK, stratum_reference_get(&state, 1, &changed));
    CHECK(changed.kind == STRATUM_TARGET_HOLD);

    EXPECT(STRATUM_OK, stratum_posture_set(&state, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_posture_set(0, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_posture_set(&state, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_posture_set(ODD(StratumState), q));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_posture_set(&state, ODD(double)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_posture_set(&blank_state, q));
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_posture_set(&state, bad));

    EXPECT(STRATUM_OK, stratum_reference_hold(&state, &controller, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_hold(0, &controller, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_hold(&state, 0, q));
    EXPECT(STRATUM_ERROR_NULL, stratum_reference_hold(&state, &controller, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_hold(ODD(StratumState), &controller, q));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_hold(&state, ODD(StratumController), q));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_reference_hold(&state, &controller, ODD(double)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_reference_hold(&blank_state, &controller, q));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_reference_hold(&state, &blank_controller, q));
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_hold(&state, &controller, bad));
}

/* A step with an argument error: zero torque. */
static void no_step(StratumResult wanted, const StratumController *c, StratumState *s,
                    const double *q_, const double *dq_) {
    torque[6] = 1.0;
    EXPECT(wanted, stratum_step(c, s, q_, dq_, 0.002, torque));
    CHECK(torque[6] == 0.0);
}

static void steps(void) {
    no_step(STRATUM_ERROR_NULL, 0, &state, q, dq);
    no_step(STRATUM_ERROR_NULL, &controller, 0, q, dq);
    no_step(STRATUM_ERROR_NULL, &controller, &state, 0, dq);
    no_step(STRATUM_ERROR_NULL, &controller, &state, q, 0);
    EXPECT(STRATUM_ERROR_NULL, stratum_step(&controller, &state, q, dq, 0.002, 0));
    no_step(STRATUM_ERROR_MISALIGNED, ODD(StratumController), &state, q, dq);
    no_step(STRATUM_ERROR_MISALIGNED, &controller, ODD(StratumState), q, dq);
    no_step(STRATUM_ERROR_MISALIGNED, &controller, &state, ODD(double), dq);
    no_step(STRATUM_ERROR_MISALIGNED, &controller, &state, q, ODD(double));
    EXPECT(STRATUM_ERROR_MISALIGNED,
           stratum_step(&controller, &state, q, dq, 0.002, ODD(double)));
    no_step(STRATUM_ERROR_UNINITIALISED, &blank_controller, &state, q, dq);
    no_step(STRATUM_ERROR_UNINITIALISED, &controller, &blank_state, q, dq);
    fresh();
    settings.level_count = 2;
    settings.levels[1].axes = STRATUM_AXIS_X;
    EXPECT(STRATUM_OK, stratum_controller_init(&other, &settings));
    fresh();
    no_step(STRATUM_ERROR_MISMATCH, &other, &state, q, dq);

    settings.levels[0].task = STRATUM_TASK_ORIENTATION;
    EXPECT(STRATUM_OK, stratum_controller_init(&other, &settings));
    fresh();
    EXPECT(STRATUM_OK, stratum_reference_hold(&state, &controller, q));
    EXPECT(STRATUM_FAULT_WRONG_TARGET, stratum_step(&other, &state, q, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_fault_text(&state, text, sizeof text));
    board_print(text);
    board_print("\n");
    EXPECT(STRATUM_OK, stratum_reset(&state));

    EXPECT(STRATUM_OK, stratum_step(&controller, &state, q, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_status(&state, &status));
    CHECK(status.fault == STRATUM_OK && status.saturated == 0 && status.rank == 0);
    EXPECT(STRATUM_OK, stratum_fault_text(&state, text, sizeof text));
    CHECK(text[0] == 0);
    double held = torque[1];
    EXPECT(STRATUM_FAULT_IMPLAUSIBLE, stratum_step(&controller, &state, bad, dq, 0.002, torque));
    CHECK(torque[1] > held - 1.0 && torque[1] < held + 1.0); /* the level was at rest */
    EXPECT(STRATUM_FAULT_IMPLAUSIBLE, stratum_step(&controller, &state, q, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_status(&state, &status));
    CHECK(status.fault == STRATUM_FAULT_IMPLAUSIBLE && status.fault_index == 1);
    EXPECT(STRATUM_OK, stratum_fault_text(&state, text, sizeof text));
    board_print(text);
    board_print("\n");
    char little[6] = "......";
    EXPECT(STRATUM_OK, stratum_fault_text(&state, little, 5));
    CHECK(little[3] == text[3] && little[4] == 0 && little[5] == '.');
    EXPECT(STRATUM_OK, stratum_reset(&state));
    EXPECT(STRATUM_FAULT_IMPLAUSIBLE, stratum_step(&controller, &state, q, bad, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_reset(&state));
    EXPECT(STRATUM_FAULT_IMPLAUSIBLE, stratum_step(&controller, &state, q, dq, bad[0], torque));
    EXPECT(STRATUM_OK, stratum_reset(&state));
    StratumReference far = reference;
    far.x[0] = stratum_precision() == 64 ? 1e308 : 3e38; /* finite, and no place */
    EXPECT(STRATUM_OK, stratum_reference_set(&state, 1, &far));
    EXPECT(STRATUM_FAULT_IMPLAUSIBLE,
           stratum_step(&controller, &state, q, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_reference_set(&state, 1, &reference));
    EXPECT(STRATUM_OK, stratum_reset(&state));
    EXPECT(STRATUM_OK, stratum_step(&controller, &state, q, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_step(&controller, &state, q, q, 0.002, q)); /* one array */
    EXPECT(STRATUM_OK, stratum_applied(&state, torque));
    EXPECT(STRATUM_OK, stratum_skip(&state));

    StratumResult (*const vectors[])(const StratumState *, double *) = {
        stratum_residual, stratum_gravity, stratum_coriolis};
    for (int i = 0; i < 3; i++) {
        EXPECT(STRATUM_OK, vectors[i](&state, torque));
        EXPECT(STRATUM_ERROR_NULL, vectors[i](0, torque));
        EXPECT(STRATUM_ERROR_NULL, vectors[i](&state, 0));
        EXPECT(STRATUM_ERROR_MISALIGNED, vectors[i](ODD(StratumState), torque));
        EXPECT(STRATUM_ERROR_MISALIGNED, vectors[i](&state, ODD(double)));
        EXPECT(STRATUM_ERROR_UNINITIALISED, vectors[i](&blank_state, torque));
    }
    EXPECT(STRATUM_ERROR_NULL, stratum_status(0, &status));
    EXPECT(STRATUM_ERROR_NULL, stratum_status(&state, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_status(ODD(StratumState), &status));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_status(&state, ODD(StratumStatus)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_status(&blank_state, &status));
    EXPECT(STRATUM_ERROR_NULL, stratum_fault_text(0, text, sizeof text));
    EXPECT(STRATUM_ERROR_NULL, stratum_fault_text(&state, 0, sizeof text));
    EXPECT(STRATUM_ERROR_TEXT_SIZE, stratum_fault_text(&state, text, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_fault_text(ODD(StratumState), text, sizeof text));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_fault_text(&blank_state, text, sizeof text));
    EXPECT(STRATUM_ERROR_NULL, stratum_applied(0, torque));
    EXPECT(STRATUM_ERROR_NULL, stratum_applied(&state, 0));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_applied(ODD(StratumState), torque));
    EXPECT(STRATUM_ERROR_MISALIGNED, stratum_applied(&state, ODD(double)));
    EXPECT(STRATUM_ERROR_UNINITIALISED, stratum_applied(&blank_state, torque));
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_applied(&state, bad));
    StratumResult (*const plain[])(StratumState *) = {stratum_skip, stratum_reset};
    for (int i = 0; i < 2; i++) {
        EXPECT(STRATUM_ERROR_NULL, plain[i](0));
        EXPECT(STRATUM_ERROR_MISALIGNED, plain[i](ODD(StratumState)));
        EXPECT(STRATUM_ERROR_UNINITIALISED, plain[i](&blank_state));
    }
}

/* Changes that cannot be, of a controller with one level and a second one that is absent. */
static void changes(void) {
    static const uint32_t both[2] = {2, 1}, twice[2] = {1, 1};
    static const double rest[7] = {0.0, 0.5, 0.0, -1.5, 0.5, 1.0, 0.0};
    double stiffness[9] = {100.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 100.0};
    double damping[9] = {20.0, 0.0, 0.0, 0.0, 20.0, 0.0, 0.0, 0.0, 20.0};
    fresh();
    settings.level_count = 2;
    settings.levels[1].axes = STRATUM_AXIS_X;
    settings.levels[1].absent = 1;
    EXPECT(STRATUM_OK, stratum_controller_init(&other, &settings));
    EXPECT(STRATUM_OK, stratum_state_init(&state, &other, rest));

    EXPECT(STRATUM_ERROR_NULL, stratum_level_add(0, &state, &settings, 2, 1, 0.5));
    EXPECT(STRATUM_ERROR_NULL, stratum_level_add(&other, 0, &settings, 2, 1, 0.5));
    EXPECT(STRATUM_ERROR_NULL, stratum_level_add(&other, &state, 0, 2, 1, 0.5));
    EXPECT(STRATUM_ERROR_MISALIGNED,
           stratum_level_add(&other, &state, ODD(StratumSettings), 2, 1, 0.5));
    EXPECT(STRATUM_ERROR_UNINITIALISED,
           stratum_level_add(&other, &blank_state, &settings, 2, 1, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_level_add(&other, &state, &settings, 0, 1, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_level_add(&other, &state, &settings, 3, 1, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_level_add(&other, &state, &settings, 8, 1, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL_TAKEN, stratum_level_add(&other, &state, &settings, 1, 1, 0.5));
    EXPECT(STRATUM_ERROR_PLACE, stratum_level_add(&other, &state, &settings, 2, 0, 0.5));
    EXPECT(STRATUM_ERROR_PLACE, stratum_level_add(&other, &state, &settings, 2, 3, 0.5));
    EXPECT(STRATUM_ERROR_CHANGE_DURATION,
           stratum_level_add(&other, &state, &settings, 2, 1, 0.01));
    EXPECT(STRATUM_ERROR_CHANGE_DURATION,
           stratum_level_remove(&other, &state, 1, bad[0]));
    settings.levels[1].axes = STRATUM_AXIS_X + STRATUM_AXIS_Y;
    EXPECT(STRATUM_ERROR_ROOM, stratum_level_add(&other, &state, &settings, 2, 1, 0.5));
    settings.levels[1].stiffness[0][0] = -1.0;
    EXPECT(STRATUM_CONFIG_GAIN_DEFINITE, stratum_level_add(&other, &state, &settings, 2, 1, 0.5));

    EXPECT(STRATUM_ERROR_LEVEL_EMPTY, stratum_level_remove(&other, &state, 2, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_level_remove(&other, &state, 0, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL_EMPTY,
           stratum_level_gains(&other, &state, 2, stiffness, damping, 0.5));
    EXPECT(STRATUM_ERROR_NULL, stratum_level_gains(&other, &state, 1, 0, damping, 0.5));
    EXPECT(STRATUM_OK, stratum_level_gains(&other, &state, 1, stiffness, damping, 0.5));
    stiffness[1] = 1.0;
    EXPECT(STRATUM_CONFIG_GAIN_SYMMETRY,
           stratum_level_gains(&other, &state, 1, stiffness, damping, 0.5));
    EXPECT(STRATUM_ERROR_ORDER, stratum_level_order(&other, &state, both, 2, 0.5));
    EXPECT(STRATUM_ERROR_ORDER, stratum_level_order(&other, &state, twice, 2, 0.5));
    EXPECT(STRATUM_ERROR_ORDER, stratum_level_order(&other, &state, both, 9, 0.5));
    EXPECT(STRATUM_ERROR_NULL, stratum_level_order(&other, &state, 0, 1, 0.5));
    settings.damping = STRATUM_DAMPING_INERTIA;
    EXPECT(STRATUM_ERROR_NULL_SPACE_KIND, stratum_null_space(&other, &state, &settings, 0.5));
    settings.damping = STRATUM_DAMPING_JOINT;
    settings.null_damping[6][6] = 1.0;
    EXPECT(STRATUM_CONFIG_DAMPING, stratum_null_space(&other, &state, &settings, 0.5));
    EXPECT(STRATUM_ERROR_LEVEL, stratum_reference_age(&state, 3, 1.0));
    EXPECT(STRATUM_ERROR_NON_FINITE, stratum_reference_age(&state, 1, bad[0]));
    EXPECT(STRATUM_OK, stratum_reference_age(&state, 1, 1.0));

    fresh();
    settings.level_count = 2;
    settings.levels[1].axes = STRATUM_AXIS_X;
    settings.levels[1].absent = 1;
    EXPECT(STRATUM_OK, stratum_level_add(&other, &state, &settings, 2, 1, 0.5));
    EXPECT(STRATUM_OK, stratum_step(&other, &state, rest, dq, 0.002, torque));
    EXPECT(STRATUM_OK, stratum_status(&state, &status));
    CHECK(status.changing == 3 && status.stale == 0);
    settings.levels[1].absent = 0;
    EXPECT(STRATUM_OK, stratum_controller_init_exact(&other, &settings));
    EXPECT(STRATUM_OK, stratum_state_init(&state, &other, rest));
    EXPECT(STRATUM_ERROR_EXACT_LAW, stratum_level_remove(&other, &state, 2, 0.5));
    EXPECT(STRATUM_ERROR_EXACT_LAW, stratum_level_order(&other, &state, both, 2, 0.5));
    fresh();
}

static void configurations(void) {
    fresh();
    REFUSED(STRATUM_ERROR_ABI, settings.abi = 0);
    REFUSED(STRATUM_ERROR_ABI, settings.abi = 1);
    REFUSED(STRATUM_CONFIG_LEVELS, settings.level_count = 8);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.levels[0].task = 2);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.levels[0].axes = 8);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.damping = 0xffffffffu);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.posture = 3);
    REFUSED(STRATUM_CONFIG_LEVELS, settings.level_count = 0);
    REFUSED(STRATUM_CONFIG_ROWS, settings.level_count = 5);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.levels[0].absent = 2);
    REFUSED(STRATUM_CONFIG_CHOICE, settings.levels[0].stale = 2);
    REFUSED(STRATUM_CONFIG_STALE_AGE, settings.levels[0].stale_after_s = bad[0]);
    REFUSED(STRATUM_CONFIG_NO_AXIS, settings.level_count = 2; settings.levels[1].axes = 0);
    REFUSED(STRATUM_CONFIG_POINT_LINK, settings.levels[0].link = 0);
    REFUSED(STRATUM_CONFIG_POINT_LINK, settings.levels[0].link = STRATUM_ON_TOOL + 1);
    REFUSED(STRATUM_CONFIG_POINT_OFFSET, settings.levels[0].offset[1] = 11.0);
    REFUSED(STRATUM_CONFIG_POINT_OFFSET, settings.levels[0].offset[1] = bad[0]);
    REFUSED(STRATUM_CONFIG_GAIN_VALUE, settings.levels[0].stiffness[2][2] = bad[0]);
    REFUSED(STRATUM_CONFIG_GAIN_VALUE, settings.null_damping[6][6] = 1e300);
    REFUSED(STRATUM_CONFIG_CYCLE, settings.cycle_s = 5e-324);
    REFUSED(STRATUM_CONFIG_GAIN_SYMMETRY, settings.levels[0].damping[0][1] = 1.0);
    REFUSED(STRATUM_CONFIG_GAIN_SYMMETRY, settings.null_stiffness[4][2] = 1.0);
    REFUSED(STRATUM_CONFIG_GAIN_DEFINITE, settings.null_stiffness[3][3] = -15.0);
    REFUSED(STRATUM_CONFIG_OBSERVER_GAIN, settings.observer_gain[6] = 0.0);
    REFUSED(STRATUM_CONFIG_CYCLE, settings.cycle_s = 0.05);
    REFUSED(STRATUM_CONFIG_DEAD_CYCLES, settings.dead_cycles = 9);
    REFUSED(STRATUM_CONFIG_DEAD_CYCLES, settings.dead_cycles = 256);
    REFUSED(STRATUM_CONFIG_INERTIA_DAMPING,
            settings.damping = STRATUM_DAMPING_INERTIA; settings.null_damping_rate = -1.0);
    REFUSED(STRATUM_CONFIG_DAMPING, settings.null_damping[6][6] = 1.0);
    REFUSED(STRATUM_CONFIG_ARM_NON_FINITE, settings.arm.links[2].com[0] = bad[0]);
    REFUSED(STRATUM_CONFIG_ARM_NOT_POSITIVE, settings.arm.links[6].torque_limit = 0.0);
    REFUSED(STRATUM_CONFIG_ARM_INERTIA, settings.arm.links[4].inertia[0] = 10.0);
    REFUSED(STRATUM_CONFIG_ARM_RANGE, settings.arm.base.rotation[0][1] = 1.0);
    REFUSED(STRATUM_CONFIG_ARM_RANGE, settings.arm.links[1].position_range[0] = 3.0);
    REFUSED(STRATUM_CONFIG_ARM_RANGE, settings.tool.mass = -1.0);
    REFUSED(STRATUM_CONFIG_ARM_NON_FINITE, settings.tool.pose.shift[2] = bad[0]);
    REFUSED(STRATUM_CONFIG_FRAME_ROTATION,
            settings.levels[0].task = STRATUM_TASK_ORIENTATION;
            settings.levels[0].rotation[2][2] = 0.5);
}

int main(void) {
    arguments();
    references();
    steps();
    changes();
    configurations();
    CHECK(stratum_abi_version() == STRATUM_ABI_VERSION);
    CHECK(stratum_error_name(-1)[0] == 'u' && stratum_error_text(12345)[0] == 'n');
    board_print(wrong ? "errors: some answers are wrong\n" : "errors: all answers are right\n");
    return wrong != 0;
}
