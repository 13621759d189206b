"""The vendor's own clients against the robot's end of the crate `fci`.

    python clients.py ROBOT MODULE VERSION ADDRESS

ROBOT is the example `robot` of the crate, MODULE pylibfranka (version 10) or
panda_py.libfranka (version 5). What the robot says that its state is must be what the
client reads, field by field and error by error; what the client asks must be what the robot
understands; a torque loop of 2 s must end clean, also with 3 % of the datagrams lost each way, a
torque that jumps by a reflex, a client that sleeps for 300 ms by another one. Exit code 0: all of it.
"""

import atexit
import importlib
import math
import queue
import re
import subprocess
import sys
import threading
import time

DOF = 7
CYCLES = 2000
# Of the state; neither client shows the accelerometers.
HIDDEN = {"accelerometer_top", "accelerometer_bottom"}
# Attributes that a client spells in another way.
SPELLING = {
    "tau_J_range_violation": "tau_j_range_violation",
    "cartesian_position_motion_generator_invalid_frame_flag": "cartesian_position_motion_generator_invalid_frame",
}
MODES = ["Other", "Idle", "Move", "Guiding", "Reflex", "UserStopped", "AutomaticErrorRecovery"]


class Robot:
    """The program, and the lines that it prints."""

    def __init__(self, program, address, version, clients, *how):
        command = [program, f"{address}:1337", str(version), str(clients), *map(str, how)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        atexit.register(self.stop)
        self.lines = queue.Queue()
        threading.Thread(target=self.collect, daemon=True).start()
        self.fields = {}
        self.errors = self.expect("errors").split()[1:]
        self.shown = int(self.expect("shown").split()[1])

    def stop(self):
        self.process.kill()
        self.process.wait()

    def collect(self):
        for line in self.process.stdout:
            self.lines.put(line.strip())
        self.lines.put("end")

    def expect(self, start):
        """The next line that begins so; others are passed over, but for fields."""
        while True:
            line = self.lines.get(timeout=10)
            if line.startswith("field "):
                _, name, *values = line.split()
                self.fields[name] = [float(value) for value in values]
            if line == "end":
                sys.exit(f"robot: ended; expected: {start}")
            if line.startswith(start):
                return line


def numbers(value):
    try:
        return [float(x) for row in value for x in (row if hasattr(row, "__len__") else [row])]
    except TypeError:
        return [float(value)]


def check(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found}; expected: {expected}")


def check_fields(state, robot):
    seen = 0
    for name, expected in robot.fields.items():
        if hasattr(state, name):
            check(name, numbers(getattr(state, name)), expected)
            seen += 1
    hidden = [name for name in robot.fields if not hasattr(state, name)]
    print(f"  fields of the state: {seen} of {len(robot.fields)} equal; not shown by the client: {' '.join(hidden) or 'none'}")
    if seen < 36:
        sys.exit(f"fields of the state: {seen}; expected: 36 or more")


def check_errors(client, robot):
    """Every error alone, at the place and time where the robot shows it."""
    modes = [mode for mode in MODES if mode != "Reflex"]
    current, reasons, nameless, seen_modes = set(), set(), set(), set()
    for _ in range(20 * robot.shown * len(robot.errors)):
        state = client.read_once()
        i = round(state.time.to_sec() * 1000) // robot.shown % len(robot.errors)
        for errors, name, seen in [
            (state.current_errors, robot.errors[i], current),
            (state.last_motion_errors, robot.errors[-1 - i], reasons),
        ]:
            shown = next((it for it in (name, SPELLING.get(name)) if it and hasattr(errors, it)), None)
            set_ones = [it for it in dir(errors) if getattr(errors, it) is True]
            check(f"errors when {name} is set", set_ones, [shown] if shown else [])
            # One that the client has no name for is an error all the same.
            check(f"any error when {name} is set", bool(errors), True)
            if shown:
                seen.add(name)
            else:
                nameless.add(name)
        mode = str(state.robot_mode).split(".")[-1].removeprefix("k")
        check("robot mode", mode, modes[i % len(modes)])
        seen_modes.add(mode)
        if len(current | nameless) == len(reasons | nameless) == len(robot.errors):
            break
    print(
        f"  errors by name: {len(current)} current, {len(reasons)} of the last motion, of {len(robot.errors)}; "
        f"without a name in the client: {' '.join(sorted(nameless)) or 'none'}; {len(seen_modes)} robot modes"
    )
    check("errors seen", len(current | nameless), len(robot.errors))
    check("reasons seen", len(reasons | nameless), len(robot.errors))


def series(count, start):
    return [start + 0.5 * i for i in range(count)]


def check_setters(client, robot, names):
    """What the robot prints of each request; Rust and Python print these numbers alike."""
    pose = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.125, 0.25, 0.375, 1.0]
    torques = [series(DOF, 20.0 + 10 * i) for i in range(4)]
    forces = [series(6, 60.0 + 10 * i) for i in range(4)]
    calls = 0

    def call(method, arguments, kind, values):
        nonlocal calls
        if not hasattr(client, method):
            return
        getattr(client, method)(*arguments)
        line = robot.expect(f"request {kind}")
        found = [float(x) for x in re.findall(r"(?<![\w])-?\d+(?:\.\d+)?(?:e-?\d+)?", line)]
        check(f"{kind} as the robot understood it", found, values)
        calls += 1

    flat = lambda lists: [x for one in lists for x in one]
    if names["collision arguments"] == 8:
        arguments = torques + forces
        # The client's order is that of the wire.
        call("set_collision_behavior", arguments, "SetCollisionBehavior", flat(torques + forces))
    lower, upper, force_lower, force_upper = torques[0], torques[1], forces[0], forces[1]
    values = flat([lower, upper] * 2 + [force_lower, force_upper] * 2)
    call("set_collision_behavior", (lower, upper, force_lower, force_upper), "SetCollisionBehavior", values)
    stiffness = series(DOF, 1000.0)
    call("set_joint_impedance", (stiffness,), "SetJointImpedance", stiffness)
    stiffness = series(3, 1000.0) + series(3, 100.0)
    call("set_cartesian_impedance", (stiffness,), "SetCartesianImpedance", stiffness)
    for method in ("set_EE", "set_ee"):
        call(method, (pose,), "SetNeToEe", pose)
    for method in ("set_K", "set_k"):
        call(method, (pose,), "SetEeToK", pose)
    inertia = [0.5, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.125]
    call("set_load", (1.5, [0.25, 0.5, 0.75], inertia), "SetLoad", [1.5, 0.25, 0.5, 0.75] + inertia)
    if hasattr(client, "set_guiding_mode"):
        client.set_guiding_mode([True, False, True, False, True, False], True)
        line = robot.expect("request SetGuidingMode")
        check("SetGuidingMode", re.findall("true|false", line), ["true", "false"] * 3 + ["true"])
        calls += 1
    client.automatic_error_recovery()
    robot.expect("request AutomaticErrorRecovery")
    # A setter shows some states later.
    for _ in range(100):
        state = client.read_once()
        if state.m_load == 1.5 and list(state.EE_T_K) == pose:
            break
    check("m_load", state.m_load, 1.5)
    check("EE_T_K", list(state.EE_T_K), pose)
    print(f"  requests: {calls + 1} understood as they were meant, answered with success, two of them seen in the state")
    try:
        client.set_joint_impedance([20000.0] * DOF)
    except Exception as error:
        print(f"  stiffness out of range: {type(error).__name__}: {error}")
    else:
        sys.exit("stiffness out of range: accepted; expected: refused")


def torque(cycle):
    """Zero at first, as answers may be late until the robot waits for them; then smooth, less
    than 1 Nm per cycle."""
    cycle = max(0, cycle - 50)
    return [0.5 * math.sin(0.01 * cycle + joint) - 0.5 * math.sin(joint) for joint in range(DOF)]


def run_torques(client, module, robot, jump_at=None, sleep_at=None):
    """A torque loop, as the client's interface has it. Torques that the robot says acted are
    those that were sent."""
    count, wrong = 0, 0.0
    last = [0.0] * DOF

    def next_torque(state):
        nonlocal count, wrong, last
        if count > 0:
            wrong = max(wrong, max(abs(a - b) for a, b in zip(state.tau_J_d, last)))
        last = torque(count) if count != jump_at else [x + 5.0 for x in torque(count)]
        command = module.Torques(last)
        if count == sleep_at:
            time.sleep(0.3)
        count += 1
        command.motion_finished = count == CYCLES
        return command

    if hasattr(client, "start_torque_control"):
        control = client.start_torque_control()
        while True:
            state, _ = control.readOnce()
            command = next_torque(state)
            control.writeOnce(command)
            if command.motion_finished:
                break
    else:
        client.control(lambda state, _: next_torque(state), False, 1000.0)
    return count, wrong


def check_motion(client, module, robot):
    count, wrong = run_torques(client, module, robot)
    # The last command's torque, and that it ends the motion.
    command = robot.expect("last Command")
    tau = re.search(r"tau_j_d: \[([^]]*)\]", command).group(1)
    check("last torque", [float(x) for x in tau.split(", ")], torque(CYCLES - 1))
    line = robot.expect("motion")
    print(f"  torque loop: {count} cycles by the client; robot: {line}; largest difference of tau_J_d {wrong:.1e} Nm")
    check("end of the motion", line.split(": ")[-1], "success")
    # Half a step of binary32 below 2 Nm.
    if wrong > 6e-8:
        sys.exit(f"tau_J_d: {wrong} Nm off; expected: 6e-8 Nm or less")


def check_generators(client, module, robot):
    """Each motion generator with the robot's own controller: what Move asks for, what the last
    command has."""
    pose = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.125, 0.25, 0.375, 1.0]
    controller = getattr(module.ControllerMode, "JointImpedance", None) or module.ControllerMode.kJointImpedance
    done = []
    for name, generator, command_type, member, values in [
        ("joint_position", "JointPosition", module.JointPositions, "q_c", series(DOF, 0.25)),
        ("joint_velocity", "JointVelocity", module.JointVelocities, "dq_c", series(DOF, 0.125)),
        ("cartesian_pose", "CartesianPosition", module.CartesianPose, "o_t_ee_c", pose),
        ("cartesian_velocity", "CartesianVelocity", module.CartesianVelocities, "o_dp_ee_c", series(6, 0.5)),
    ]:
        count = 0

        def next_command(_state):
            nonlocal count
            count += 1
            command = command_type(values)
            command.motion_finished = count == 10
            return command

        if hasattr(client, f"start_{name}_control"):
            control = getattr(client, f"start_{name}_control")(controller)
            while count < 10:
                state, _ = control.readOnce()
                control.writeOnce(next_command(state))
        else:
            getattr(client, f"control_{name}")(lambda state, _: next_command(state), controller, False, 1000.0)
        move = robot.expect("request Move")
        check("Move", re.findall(r"\b(controller|generator): (\w+)", move), [("controller", "JointImpedance"), ("generator", generator)])
        deviation = [10.0, 3.12, 2 * math.pi]
        found = re.findall(r"deviation: \[([^]]*)\]", move)
        check("deviations", [[float(x) for x in one.split(", ")] for one in found], [deviation] * 2)
        command = robot.expect("last Command")
        found = re.search(rf" {member}: \[([^]]*)\]", command).group(1)
        check(member, [float(x) for x in found.split(", ")], values)
        check("end of the motion", robot.expect("motion").split(": ")[-1], "success")
        done.append(f"{name} in {member}")
    print(f"  motion generators: {', '.join(done)}")


def check_reflex(client, module, robot):
    try:
        run_torques(client, module, robot, jump_at=100)
    except Exception as error:
        print(f"  torque that jumps: {type(error).__name__}: {error}")
        if "controller_torque_discontinuity" not in str(error):
            sys.exit("reflex: another reason; expected: controller_torque_discontinuity")
    else:
        sys.exit("torque that jumps: accepted; expected: a reflex")
    print(f"  robot: {robot.expect('motion')}")
    client.automatic_error_recovery()


def check_loss(client, module, robot):
    """Commands and states are lost, 3 % of each: the motion goes on and ends as it should."""
    count, _ = run_torques(client, module, robot)
    line = robot.expect("motion")
    print(f"  3 % lost each way: {count} cycles by the client; robot: {line}")
    check("end of the motion", line.split(": ")[-1], "success")
    lost = int(re.search(r"(\d+) lost", line).group(1))
    # 6 % of 2000 cycles within six standard deviations.
    if not 60 < lost < 190:
        sys.exit(f"lost: {lost} commands; expected: 60 to 190")


def check_sleep(client, module, robot):
    """A client that sleeps, and a robot that does not wait for it."""
    try:
        run_torques(client, module, robot, sleep_at=100)
    except Exception as error:
        print(f"  client that sleeps for 300 ms: {type(error).__name__}: {error}")
        if "communication_constraints_violation" not in str(error):
            sys.exit("reflex: another reason; expected: communication_constraints_violation")
    else:
        sys.exit("client that sleeps for 300 ms: accepted; expected: a reflex")
    print(f"  robot: {robot.expect('motion')}")
    client.automatic_error_recovery()


def main():
    program, name, version, address = sys.argv[1:]
    version = int(version)
    module = importlib.import_module(name)
    robot = Robot(program, address, version, 2)
    client = module.Robot(address, module.RealtimeConfig.kIgnore)
    print(f"{name}, version {version}")
    check_fields(client.read_once(), robot)
    check_errors(client, robot)
    check_setters(client, robot, {"collision arguments": 8 if version == 5 else 4})
    check_motion(client, module, robot)
    check_generators(client, module, robot)
    check_reflex(client, module, robot)
    del client
    robot.expect("closed")
    robot.stop()

    for how, check_it in [((0.03,), check_loss), ((0, 1), check_sleep)]:
        robot = Robot(program, address, version, 1, *how)
        client = module.Robot(address, module.RealtimeConfig.kIgnore)
        check_it(client, module, robot)
        del client
        robot.expect("closed")
        robot.stop()

    # A robot of another version.
    other = 10 if version == 5 else 5
    robot = Robot(program, address, other, 1)
    try:
        module.Robot(address, module.RealtimeConfig.kIgnore)
    except Exception as error:
        print(f"  robot of version {other}: {type(error).__name__}: {error}")
    else:
        sys.exit(f"robot of version {other}: accepted; expected: refused")
    robot.stop()


if __name__ == "__main__":
    main()
