//! Logs to be changed: their messages and calls, and files of other ones.

use std::collections::BTreeMap;
use std::io::Cursor;

use ramp_log::calls::{Decoder, Encoder, Entry};

/// The topics and contents of a log's messages.
#[must_use]
pub fn messages(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    mcap::MessageStream::new(bytes)
        .unwrap()
        .map(|message| message.unwrap())
        .map(|message| (message.channel.topic.clone(), message.data.into_owned()))
        .collect()
}

/// A file of these messages.
#[must_use]
pub fn as_log(messages: &[(String, Vec<u8>)]) -> Vec<u8> {
    write_log(messages, mcap::WriteOptions::new())
}

/// A file of these messages, written with other options.
#[must_use]
pub fn write_log(messages: &[(String, Vec<u8>)], options: mcap::WriteOptions) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut file = options.compression_threads(0).create(&mut bytes).unwrap();
    let mut channels = BTreeMap::new();
    for (topic, data) in messages {
        let encoding = if topic == "/calls" { ramp_log::CALLS } else { "json" };
        let channel_id = *channels
            .entry(topic.clone())
            .or_insert_with(|| file.add_channel(0, topic, encoding, &BTreeMap::new()).unwrap());
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        file.write_to_known_channel(&header, data).unwrap();
    }
    file.finish().unwrap();
    drop(file);
    bytes.into_inner()
}

/// The entries of a log's calls.
#[must_use]
pub fn entries(bytes: &[u8]) -> Vec<Entry> {
    let messages = messages(bytes);
    let calls = messages.into_iter().filter(|(topic, _)| topic == "/calls").flat_map(|(_, data)| data);
    Decoder::new(&calls.collect::<Vec<u8>>()).map(Result::unwrap).collect()
}

/// A log with other calls.
#[must_use]
pub fn with_entries(bytes: &[u8], entries: &[Entry]) -> Vec<u8> {
    let mut messages = messages(bytes);
    let mut encoder = Encoder::default();
    for entry in entries {
        match entry {
            Entry::Step(command, periods) => (0..*periods).for_each(|_| encoder.step(command)),
            Entry::ReadParts => encoder.read_parts(),
            Entry::Look(camera, width) => encoder.look(*camera, *width),
            Entry::Expose => encoder.expose(),
            Entry::Answered(hash) => encoder.answered(*hash),
            Entry::Refused => encoder.refused(),
            Entry::State(hash) => encoder.state(*hash),
        }
    }
    messages.retain(|(topic, _)| topic != "/calls");
    messages.insert(1, ("/calls".to_string(), encoder.take()));
    as_log(&messages)
}
