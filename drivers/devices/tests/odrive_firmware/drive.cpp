// The firmware's parser on a pseudo-terminal: prints its name, and ends with its standard input.
#include "odrive_main.h"
#include "ascii_protocol.hpp"
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

Axis axes[AXIS_COUNT];
ODrive odrv;
char serial_number_str[13] = "376E36573131";

static double now_s() {
    timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

void Axis::watchdog_feed() {
    fed_s = now_s();
}

void ODrive::clear_errors() {
    error = 0;
    for (Axis& axis : axes)
        axis.error = axis.motor_.error = axis.encoder_.error = axis.controller_.error = 0;
}

void Axis::advance(double now_s, float dt_s) {
    constexpr unsigned char IDLE = 1, CLOSED_LOOP = 8;
    constexpr float RISE_S = 0.02f, INERTIA_KG_M2 = 1e-3f, TURN_RAD = 6.2831853f;
    if (requested_state != 0) {
        if (requested_state == CLOSED_LOOP)
            watchdog_feed();
        current_state = requested_state;
        requested_state = 0;
    }
    if (enable_watchdog && now_s - fed_s > watchdog_timeout && current_state == CLOSED_LOOP) {
        error |= 0x800;
        current_state = IDLE;
    }
    float& velocity = encoder_.vel_estimate_.value;
    float torque_nm = 0.0f;
    if (current_state == CLOSED_LOOP) {
        torque_nm = controller_.input_torque_;
        if (controller_.config_.control_mode == Controller::CONTROL_MODE_VELOCITY_CONTROL)
            torque_nm += (controller_.input_vel_ - velocity) * TURN_RAD * INERTIA_KG_M2 / RISE_S;
    }
    velocity += torque_nm / INERTIA_KG_M2 / TURN_RAD * dt_s;
    encoder_.pos_estimate_.value += velocity * dt_s;
    motor_.iq_measured = torque_nm / motor_.config_.torque_constant;
    // The position of the link encoder behind a gear.
    axes[1].encoder_.pos_estimate_.value = axes[0].encoder_.pos_estimate_.value / 50.0f;
}

struct Terminal final : fibre::AsyncStreamSource, fibre::AsyncStreamSink {
    int master = -1;
    fibre::bufptr_t buffer;
    fibre::Callback<void, fibre::ReadResult> waiting;

    void start_read(fibre::bufptr_t into, fibre::TransferHandle*, fibre::Callback<void, fibre::ReadResult> done) override {
        buffer = into;
        waiting = done;
    }
    void cancel_read(fibre::TransferHandle) override {}
    void start_write(fibre::cbufptr_t from, fibre::TransferHandle*, fibre::Callback<void, fibre::WriteResult> done) override {
        ssize_t written = write(master, from.begin(), from.size());
        // Unread bytes are lost, as on a cable without flow control.
        (void)written;
        done.invoke({fibre::kStreamOk, from.end()});
    }
    void cancel_write(fibre::TransferHandle) override {}

    void receive() {
        ssize_t count = read(master, buffer.begin(), buffer.size());
        if (count > 0)
            waiting.invoke_and_clear({fibre::kStreamOk, buffer.begin() + count});
    }
};

int main() {
    static Terminal terminal;
    terminal.master = posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal.master < 0 || grantpt(terminal.master) || unlockpt(terminal.master))
        return 1;
    const char* name = ptsname(terminal.master);
    // Kept open: without it reads fail as soon as a client disconnects.
    int kept = open(name, O_RDWR | O_NOCTTY);
    termios raw;
    tcgetattr(kept, &raw);
    cfmakeraw(&raw);
    tcsetattr(kept, TCSANOW, &raw);
    printf("%s\n", name);
    fflush(stdout);

    static AsciiProtocol protocol(&terminal, &terminal);
    protocol.start();
    double last_s = now_s();
    for (;;) {
        pollfd ends[2] = {{terminal.master, POLLIN, 0}, {0, POLLIN, 0}};
        poll(ends, 2, 1);
        if (ends[1].revents)
            return 0;
        double at_s = now_s();
        axes[0].advance(at_s, at_s - last_s);
        last_s = at_s;
        if (ends[0].revents & POLLIN)
            terminal.receive();
    }
}
