//! Tests of valid descriptions and of error messages.

use super::*;

fn parse(file: &str, text: &str) -> Result<Vec<BenchDescription>, ConfigErrors> {
    super::parse(file, text).map(|description| description.benches)
}

#[test]
fn the_ready_made_descriptions_are_right() {
    for (name, text) in READY_MADE {
        let benches = parse(name, text).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!((benches.len(), benches[0].name.as_str()), (1, name));
        assert_eq!(benches[0].is_simulated(), name.ends_with("-mock"));
        assert_eq!(
            benches[0].limits.brake_power_w == 0.0,
            name.starts_with("encoder") || name.starts_with("puma"),
            "a limit for a brake there is"
        );
    }
}

#[test]
fn a_mock_takes_the_data_sheet_and_what_is_given_goes_before_it() {
    let benches =
        parse("b.toml", "[[bench]]\nname = \"b\"\nmock.joint = \"b\"\nlimits.temperature_c = 50.0\n").unwrap();
    assert_eq!(benches[0].constants.gear_ratio, 50.0);
    assert_eq!(benches[0].limits.temperature_c, 50.0);
}

#[test]
fn a_mock_of_the_documents_takes_their_brakes_and_axes() {
    let mock = |line: &str| parse("b.toml", &format!("[[bench]]\nname = \"b\"\n[bench.mock]\n{line}\n"));
    let rated_nm = |line| mock(line).unwrap()[0].constants.brake_rated_torque_nm;
    assert_eq!(rated_nm("joint = \"a\""), 13.0);
    assert_eq!(rated_nm("joint = \"a\"\ndocuments = true"), 15.0);
    assert_eq!(rated_nm("joint = \"a\"\ndocuments = true\nload = \"gear_and_brake_b\""), 150.0);
    assert_eq!(mock("joint = \"puma\"\naxis = 4").unwrap()[0].constants.gear_ratio, 76.0364);
    for (line, expected) in [
        ("joint = \"puma\"\naxis = 7", "line 5: axis 7: choose 1 to 6"),
        ("joint = \"a\"\naxis = 2", "line 5: this joint is not a Puma-type arm: remove axis"),
    ] {
        let message = mock(line).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} in\n{message}");
    }
}

#[test]
fn every_mistake_is_named_at_its_line() {
    let text = "[[bench]]
name = \"bench one\"
[bench.joint]
driver = \"odrve\"
port = \"/dev/ttyUSB0\"
[bench.brake]
driver = \"scpi\"
port = \"/dev/ttyUSB0\"
deadline_ms = 0
[bench.limits]
motor_velocity_rad_s = -3.0
motor_current_a = 5.0
link_torque_nm = 18.0
temperature_c = 70.0
brake_current_a = nan
brake_power_w = 350.0

[[bench]]
name = \"two\"
";
    let errors = parse("bench.toml", text).unwrap_err();
    let message = errors.to_string();
    for expected in [
        "line 2: name \"bench one\"",
        "line 4: unknown driver \"odrve\": write \"odrive\" or \"puma\"",
        "line 8: port \"/dev/ttyUSB0\" is already used by another instrument",
        "line 9: deadline_ms 0: choose 1 to 10000",
        "line 11: limits.motor_velocity_rad_s = -3: expected a number above 0",
        "line 15: limits.brake_current_a = NaN: expected a number above 0",
        "line 2: constants.gear_ratio is missing",
        "line 19: bench \"two\" has no joint: add [bench.joint], or [bench.mock]",
    ] {
        assert!(message.contains(expected), "{expected:?} in\n{message}");
    }
    assert!(errors.errors.windows(2).all(|pair| pair[0].line <= pair[1].line));
}

#[test]
fn every_role_names_its_mistakes() {
    let text = "[[bench]]
name = \"e\"
[bench.joint]
driver = \"odrive\"
port = \"usb://\"
[bench.torque_sensor]
driver = \"multimeter\"
port = \"tcp://10.0.0.7\"
range = \"fine\"
nominal_nm = 20.0
calibrated = 2999-01-01
[bench.reference_encoder]
driver = \"qsb\"
port = \"usb://1\"
counts_per_turn = 3
[bench.test_encoder]
driver = \"qsb\"
port = \"usb://1\"
counts_per_turn = 262144
status_input = 4
[bench.stage]
driver = \"pi\"
port = \"tcp://10.0.0.8:50000\"
calibrated = 2026-03-31T12:00:00
[bench.thermometer]
driver = \"adam\"
port = \"/dev/ttyUSB3\"
channels = []
";
    let message = parse("bench.toml", text).unwrap_err().to_string();
    for expected in [
        "line 5: port has no serial number: write usb://",
        "line 8: port has no host or port number: write tcp://host:port",
        "line 9: range does not apply to a multimeter: remove it",
        "line 11: calibrated = 2999-01-01 is in the future",
        "line 15: counts_per_turn 3: choose 4 to",
        "line 18: port \"usb://1\" is already used by another instrument",
        "line 20: status_input 4: choose 0 to 3",
        "line 22: unknown driver \"pi\": write \"gcs\"",
        "line 24: calibrated = 2026-03-31T12:00:00: write a date",
        "line 26: channels is empty",
        "line 2: constants.gear_ratio is missing",
    ] {
        assert!(message.contains(expected), "{expected:?} in\n{message}");
    }
    assert!(!message.contains("limits.brake"), "no brake, no limit for it:\n{message}");
}

#[test]
fn a_limit_beyond_the_instrument_protects_nothing() {
    let (_, text) = READY_MADE.iter().find(|(name, _)| *name == "joint-a").unwrap();
    let text =
        text.replace("link_torque_nm = ", "link_torque_nm = 1").replace("brake_current_a = ", "brake_current_a = 1");
    let message = parse("bench.toml", &text).unwrap_err().to_string();
    assert!(
        message.contains("the range of the torque sensor is") && message.contains("the brake is rated for"),
        "{message}"
    );
    let message = parse("b.toml", "[[bench]]\nname = \"a\"\n[bench.mock]\njoint = \"z\"\n").unwrap_err().to_string();
    assert!(message.contains("unknown joint \"z\"") && !message.contains("missing"), "{message}");
}

#[test]
fn what_toml_itself_refuses_has_a_line_too() {
    for (text, line, message) in [
        ("[[bench]]\nname = \n", 2, ""),
        ("[[bench]]\nname = \"a\"\nmok.joint = \"a\"\n", 3, "unknown value mok: did you mean mock?"),
        ("[[bench]]\nname = \"a\"\n\n[bench.mock]\njoint = 3\n", 5, "expected a string"),
        ("", 1, "no bench described"),
    ] {
        let errors = parse("b.toml", text).unwrap_err();
        assert_eq!(errors.errors[0].line, Some(line), "{errors}");
        assert!(errors.to_string().contains(message), "{errors}");
    }
}

#[test]
fn a_puma_tells_what_its_driver_needs_and_nothing_of_another() {
    let text = "[[bench]]
name = \"arm\"
[bench.joint]
driver = \"puma\"
port = \"/dev/ttyUSB0\"
link_encoder = true
counts_per_turn = 800
ninter = 0
";
    let message = parse("bench.toml", text).unwrap_err().to_string();
    for expected in [
        "line 4: a puma requires counts_per_turn of its encoder and amperes_per_volt",
        "line 6: link_encoder does not apply to driver \"puma\": remove it",
        "line 8: ninter 0: choose 1 (0.875 ms), 2 (1.75 ms), 4 (3.5 ms), 8 (7 ms), 16 (14 ms), 32 (28 ms)",
    ] {
        assert!(message.contains(expected), "{expected:?} in\n{message}");
    }
    let text = text.replace("puma", "odrive");
    let message = parse("bench.toml", &text).unwrap_err().to_string();
    assert!(message.contains("line 8: ninter does not apply to driver \"odrive\": remove it"), "{message}");
    let mock = "[[bench]]\nname = \"arm\"\n[bench.mock]\njoint = \"puma\"\nload = \"brake_a\"\n";
    let message = parse("bench.toml", mock).unwrap_err().to_string();
    assert!(message.contains("line 5: this joint has no load"), "{message}");
    let geared = |joint: &str| {
        let servo = "servo = { velgan = 8, inttol = 300 }\nninter = 16";
        parse("bench.toml", &format!("[[bench]]\nname = \"arm\"\n[bench.mock]\njoint = \"{joint}\"\n{servo}\n"))
    };
    assert!(geared("puma").is_ok());
    let message = geared("a").unwrap_err().to_string();
    assert!(message.contains("line 5: this joint is not a Puma-type arm: remove servo"), "{message}");
    assert!(message.contains("line 6: this joint is not a Puma-type arm: remove ninter"), "{message}");
}

#[test]
fn a_bad_day_comes_to_an_instrument_that_can_have_it() {
    let planned = |instrument: &str, trouble: &str, more: &str| {
        let planned = format!("{{ instrument = \"{instrument}\", trouble = \"{trouble}\", from_s = 3.0{more} }}");
        parse("b.toml", &format!("[[bench]]\nname = \"a\"\n[bench.mock]\njoint = \"a\"\ntroubles = [{planned}]\n"))
    };
    let bench = |instrument: &str, trouble: &str| planned(instrument, trouble, "");
    for (instrument, trouble, more, expected) in [
        ("joint", "current_lost", "", "line 5: \"joint\" cannot have the trouble \"current_lost\""),
        ("stage", "silent", "", "line 5: this bench has no \"stage\""),
        ("brake", "silent", ", until_s = 2.5", "line 5: until_s = 2.5 must be later than from_s = 3"),
        ("brake", "silnet", "", "line 5: unknown value silnet: did you mean silent?"),
    ] {
        let message = planned(instrument, trouble, more).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} in\n{message}");
    }
    assert!(planned("brake", "current_lost", ", until_s = 3.5").is_ok());
    assert!(bench("disk", "disk_full").is_ok());
    for (instrument, trouble) in [("brake", "disk_full"), ("disk", "silent")] {
        let message = bench(instrument, trouble).unwrap_err().to_string();
        assert!(message.contains("line 5: instrument \"disk\" and trouble \"disk_full\" belong together"), "{message}");
    }
}

#[test]
fn a_run_carries_the_description_of_its_own_bench() {
    let [one, other] = ["one", "other"].map(|name| {
        format!("[[bench]]\nname = \"{name}\"\n\n[bench.mock]\njoint = \"a\"\neffects = []\n# The end of {name}.\n\n")
    });
    let benches = parse("bench.toml", &format!("# Two of them.\n{one}{other}")).unwrap();
    assert_eq!([&benches[0].text, &benches[1].text], [&one, &other]);
    let alone = format!("# Only one.\n{one}");
    assert_eq!(parse("bench.toml", &alone).unwrap()[0].text, alone);
}

#[test]
fn targets_of_notifications_are_checked_and_hide_their_secrets() {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bench.toml").display().to_string();
    std::fs::write(folder.path().join("key"), "correct horse\n").unwrap();
    let text = format!(
        "{bench}[[notify]]\nwebhook = \"https://hooks.example.org/T0/hidden\"\nsecret_file = \"key\"\n\
         [[notify]]\nevents = [\"unsafe\"]\nmail = \"lab@example.org\"\nfrom = \"Bench <bench@example.org>\"\n\
         smtp = \"smtps://bench%40example.org@mail.example.org\"\nsecret_file = \"key\"\n\
         [[notify]]\nname = \"broker\"\nmqtt = \"mqtt://broker.lab\"\ntopic = \"lab/bench\"\n"
    );
    let description = super::parse(&file, &text).unwrap();
    let targets = &description.notify.targets;
    let names: Vec<&str> = targets.iter().map(|target| target.name.as_str()).collect();
    assert_eq!(names, ["https://hooks.example.org", "lab@example.org", "broker"]);
    assert_eq!((targets[0].events.len(), &targets[1].events[..]), (4, &[NotifyEvent::Unsafe][..]));
    let Channel::Mail { server, .. } = &targets[1].channel else { panic!("{targets:?}") };
    let login = server.login.as_ref().map(|(user, password)| (user.as_str(), password.reveal()));
    assert_eq!((server.port, server.tls, login), (465, true, Some(("bench@example.org", "correct horse"))));
    let shown = format!("{targets:?} {}", description.benches[0].text);
    assert!(!shown.contains("hidden") && !shown.contains("horse"), "{shown}");
    assert_eq!(description.benches[0].text, bench, "a run carries no targets");
}

#[test]
fn mistakes_of_targets_are_named_at_their_lines() {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n[[notify]]\n";
    for (lines, expected) in [
        ("", "line 4: [[notify]] has one target: give webhook, mail or mqtt"),
        ("webhook = \"hooks.example.org\"", "line 5: webhook is not an address: write https://host/path"),
        ("webhook = \"https://u:p@example.org\"", "line 5: webhook contains a user"),
        ("webhook = \"https://example.org\"\ntopic = \"a\"", "line 6: topic belongs to mqtt: remove it"),
        ("webhook = \"https://example.org\"\nevents = []", "line 4: events is empty"),
        (
            "webhook = \"https://example.org\"\nevents = [\"finised\"]",
            "line 6: unknown event \"finised\": write \"finished\" or",
        ),
        ("webhook = \"https://example.org\"\nsecret_file = \"none\"", "line 6: secret_file none: cannot be read"),
        (
            "webhook = \"https://example.org\"\nsecret_env = \"NO_SUCH_KEY\"",
            "line 6: secret_env NO_SUCH_KEY is not set",
        ),
        ("mail = \"lab\"", "line 5: mail \"lab\": write a mail address"),
        ("mail = \"a@b.c\"", "line 4: mail needs smtp, such as smtps://user@host: add it"),
        ("mqtt = \"mqtt://u:p@lab\"\ntopic = \"a\"", "line 5: mqtt contains a password: remove it"),
        ("mqtt = \"mqtt://u@lab\"\ntopic = \"a\"", "line 5: mqtt has a user without a password"),
        ("mqtt = \"mqtt://lab\"\ntopic = \"a/#\"", "line 6: topic \"a/#\": write the name of one topic"),
    ] {
        let message = parse("bench.toml", &format!("{bench}{lines}\n")).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} in\n{message}");
        assert!(!message.contains("u:p"), "{message}");
    }
    let twice = format!("{bench}webhook = \"https://a.b/1\"\n[[notify]]\nwebhook = \"https://a.b/2\"\n");
    let message = parse("bench.toml", &twice).unwrap_err().to_string();
    assert!(message.contains("line 6: target \"https://a.b\" exists twice"), "{message}");
    let hidden = "notify = [{ webhook = \"https://a.b\" }]\n[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    let message = parse("bench.toml", hidden).unwrap_err().to_string();
    assert!(message.contains("line 1: write each target of notifications as a table [[notify]]"), "{message}");
}

#[test]
fn torsion_is_monitored_where_it_is_measured() {
    let parsed = |bench: &str, torsion: &str| {
        parse("b.toml", &format!("[[bench]]\nname = \"b\"\n[bench.mock]\n{bench}\n[bench.torsion]\n{torsion}\n"))
    };
    let given = "compliance_rad_per_nm = 1.8e-4\ntolerance_rad = 2e-3";
    let limit = parsed("joint = \"a\"", given).unwrap()[0].torsion.unwrap();
    assert_eq!((limit.compliance_rad_per_nm, limit.tolerance_rad), (1.8e-4, 2e-3));
    for (bench, torsion, expected) in [
        ("joint = \"puma\"", given, "line 5: torsion: this bench has no torque sensor"),
        (
            "joint = \"a\"",
            "compliance_rad_per_nm = 0.0\ntolerance_rad = 2e-3",
            "line 6: torsion.compliance_rad_per_nm = 0",
        ),
        ("joint = \"a\"", "compliance_rad_per_nm = 1.8e-4", "missing field `tolerance_rad`"),
    ] {
        let message = parsed(bench, torsion).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} in\n{message}");
    }
}

#[test]
fn an_archive_is_a_folder() {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    let archive = |lines: &str| super::parse("b.toml", &format!("{bench}[archive]\n{lines}\n"));
    let given = archive("url = \"file:///srv/joint%20bench\"").unwrap().archive.unwrap();
    assert_eq!((given.folder.as_str(), given.raw), ("/srv/joint bench", false));
    assert_eq!(given.contents().len(), 1);
    assert!(archive("url = \"file:///srv/jointbench\"\nraw = true").unwrap().archive.unwrap().raw);
    assert_eq!(super::parse("b.toml", bench).unwrap().archive, None);
    for (lines, expected) in [
        ("url = \"gs://bucket/joint\"", "line 5: archive.url: an archive at gs:// is not supported"),
        ("url = \"/srv/jointbench\"", "line 5: archive.url \"/srv/jointbench\": write file:// and an absolute path"),
        ("url = \"file://host/srv\"", "write file:// and an absolute path"),
        ("url = \"file:///\"", "write file:// and an absolute path"),
        ("raw = true", "missing field `url`"),
    ] {
        let message = archive(lines).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} in\n{message}");
    }
}

#[test]
fn an_archive_in_a_bucket_needs_the_feature() {
    let bench = "[[bench]]\nname = \"a\"\nmock.joint = \"a\"\n";
    let archive = |url: &str| super::parse("b.toml", &format!("{bench}[archive]\nurl = \"{url}\"\n"));
    let given = archive("s3://bucket/lab-1");
    assert_eq!(given.is_ok(), cfg!(feature = "s3"));
    match given {
        Ok(given) => assert_eq!(given.archive.unwrap().folder, "s3://bucket/lab-1"),
        Err(fault) => {
            let expected = "b.toml, line 5: archive.url \"s3://bucket/lab-1\": this build of jointbench has no object \
                storage: build it with `--features s3`";
            assert!(fault.to_string().contains(expected), "{fault}");
        }
    }
    for wrong in ["s3://", "s3://key:secret@bucket", "s3://bucket/", "s3://bucket//a", "s3://bucket/../a"] {
        let message = archive(wrong).unwrap_err().to_string();
        assert!(
            message.contains("line 5: archive.url: write s3://BUCKET or") && !message.contains("secret"),
            "{message}"
        );
    }
}
