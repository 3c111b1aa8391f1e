import './style/tokens.css';
import './style/base.css';
import { mount } from 'svelte';
import App from './App.svelte';
import './state/theme.svelte';

/** The frame that came with the first answer makes room. */
const target = document.getElementById('app')!;
target.replaceChildren();
mount(App, { target });
