import './style/tokens.css';
import './style/base.css';
import { mount } from 'svelte';
import App from './App.svelte';
import './state/theme.svelte';

/** Removes the page frame that was part of the first response. */
const target = document.getElementById('app')!;
target.replaceChildren();
mount(App, { target });
