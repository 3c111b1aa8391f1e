// The parts of a drive that the firmware's parser needs, with a motor that follows its set-points.
#pragma once
#define HW_VERSION_MAJOR 3
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <algorithm>
#include <cmath>
#include <optional>

// Types as on the drive's processor: a long has 32 bits, and an enumeration is as short as possible.
using word_t = unsigned long;

struct Controller {
    enum ControlMode : unsigned char {
        CONTROL_MODE_TORQUE_CONTROL = 1,
        CONTROL_MODE_VELOCITY_CONTROL = 2,
        CONTROL_MODE_POSITION_CONTROL = 3
    };
    enum InputMode : unsigned char { INPUT_MODE_PASSTHROUGH = 1, INPUT_MODE_TRAP_TRAJ = 5 };
    struct {
        ControlMode control_mode = CONTROL_MODE_POSITION_CONTROL;
        InputMode input_mode = INPUT_MODE_PASSTHROUGH;
        float vel_limit = 2.0f;
    } config_;
    word_t error = 0;
    float input_pos_ = 0.0f, input_vel_ = 0.0f, input_torque_ = 0.0f;
    void input_pos_updated() {}
};

struct Estimate {
    float value = 0.0f;
    std::optional<float> any() const { return value; }
};

struct Encoder {
    word_t error = 0;
    Estimate pos_estimate_, vel_estimate_;
    void set_linear_count(int) {}
};

struct Motor {
    struct {
        float torque_constant = 0.04f, current_lim = 10.0f, torque_lim = INFINITY;
    } config_;
    unsigned long long error = 0;
    float iq_measured = 0.0f, fet_celsius = 31.5f, motor_celsius = 28.25f;
};

struct Axis {
    Controller controller_;
    Encoder encoder_;
    Motor motor_;
    word_t error = 0;
    unsigned char current_state = 1, requested_state = 0;
    bool enable_watchdog = false;
    float watchdog_timeout = 0.0f;
    double fed_s = 0.0;
    void watchdog_feed();
    /// One cycle of the control loop.
    void advance(double now_s, float dt_s);
};

struct ODrive {
    int hw_version_major_ = 3, hw_version_minor_ = 6, hw_version_variant_ = 56;
    int fw_version_major_ = 0, fw_version_minor_ = 5, fw_version_revision_ = 6;
    float vbus_voltage = 24.087744f;
    word_t error = 0;
    void save_configuration() {}
    void erase_configuration() {}
    void reboot() {}
    void clear_errors();
};

constexpr unsigned AXIS_COUNT = 2;
extern Axis axes[AXIS_COUNT];
extern ODrive odrv;
extern char serial_number_str[13];
