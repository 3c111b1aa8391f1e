//! `jointbench notify`: targets of notifications, and test messages.

use super::arguments::Notify;
use super::client::Client;
use super::exit::{Done, Exit};
use super::print::json_out;
use super::units::print_rows;
use crate::view::{NotificationTarget, NotificationTest, word};

pub fn notify(arguments: &Notify) -> Done {
    let client = Client::new(&arguments.reach)?;
    match arguments.test {
        true => test(&client.post::<Vec<_>>("/notifications/test", &())?, arguments.json),
        false => list(&client.get::<Vec<_>>("/notifications")?, arguments.json),
    }
}

const HEAD: [&str; 5] = ["target", "events", "pending", "failed", "last delivery"];

fn list(targets: &[NotificationTarget], json: bool) -> Done {
    if json {
        return json_out(&targets);
    }
    if targets.is_empty() {
        println!("no targets: add [[notify]] to the bench description (docs/network.md)");
        return Ok(());
    }
    print_rows(&HEAD, targets.iter().map(cells));
    for target in targets {
        target.last_error.iter().for_each(|error| println!("{}: {error}", target.name));
    }
    Ok(())
}

fn cells(target: &NotificationTarget) -> [String; 5] {
    let events: Vec<String> = target.events.iter().map(word).collect();
    [
        target.name.clone(),
        events.join(", "),
        target.pending.to_string(),
        target.failed.to_string(),
        target.last_delivery.clone().unwrap_or_else(|| "–".into()),
    ]
}

fn test(outcomes: &[NotificationTest], json: bool) -> Done {
    if json {
        json_out(&outcomes)?;
    } else {
        for NotificationTest { name, kind, error } in outcomes {
            match error {
                None => println!("  ok    {kind:<8} {name}"),
                Some(error) => println!("  FAIL  {kind:<8} {name}: {error}"),
            }
        }
    }
    match outcomes.iter().filter(|outcome| outcome.error.is_some()).count() {
        0 => Ok(()),
        failed => Err(Exit::failed(format!("{failed} of {} targets did not get the test message", outcomes.len()))),
    }
}
