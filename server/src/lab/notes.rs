//! Notes and tags of runs.

use super::names::{self, LONGEST_NOTE, LONGEST_TAG};
use super::{Answer, Lab, LabError};
use crate::store::NoteRecord;
use crate::view::{LiveMessage, NewNote, Note, Run};

const MOST_TAGS: usize = 20;

impl Lab {
    pub async fn notes(&self, run: i64) -> Answer<Vec<Note>> {
        Ok(self.inner.store.notes(run).await?.into_iter().map(view).collect())
    }

    pub async fn write_note(&self, run: i64, new: &NewNote) -> Answer<Note> {
        let text = names::checked_text("text", &new.text, LONGEST_NOTE)?;
        let note = view(self.inner.store.save_note(run, new.at_s, text).await?);
        self.hub().publish(LiveMessage::Note { run, note: note.clone() });
        Ok(note)
    }

    /// Replaces the tags of a run.
    pub async fn set_tags(&self, run: i64, tags: &[String]) -> Answer<Run> {
        let tags: Vec<String> = tags.iter().map(|tag| tag.trim().to_owned()).collect();
        if tags.len() > MOST_TAGS {
            return Err(LabError::Invalid(format!("tags: at most {MOST_TAGS}, these are {}", tags.len())));
        }
        // The search cannot express these tags.
        let odd = |tag: &&String| names::checked("tag", tag, LONGEST_TAG).is_err() || tag.contains(['"', ' ']);
        if let Some(tag) = tags.iter().find(odd) {
            return Err(LabError::Invalid(format!("tag {tag:?}: write one word of at most {LONGEST_TAG} characters")));
        }
        self.inner.store.set_tags(run, &tags).await?;
        self.run(run).await
    }

    pub async fn tags(&self) -> Answer<Vec<String>> {
        Ok(self.inner.store.tags().await?)
    }
}

fn view(record: NoteRecord) -> Note {
    Note { id: record.id, at_s: record.at_s, text: record.text, created_at: record.created_at }
}
